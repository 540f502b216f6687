#include "residency_samples.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sightcell::test {
namespace {

struct residency_decoder {
  format::residency_table table;
  std::vector<std::byte> memory;
  std::vector<std::uint8_t> levels;
  const format::residency_codes* codes = nullptr;

  format::status open(const format::reader& file) {
    if (const format::status s = format::residency_table::open(file, table); s != format::status::ok) return s;
    memory.resize(format::residency_table::codes_size());
    levels.resize(table.texture_count());
    return table.make_codes(memory, codes);
  }
};

}  // namespace

sample_residency::sample_residency(const sample_contents& contents) {
  textures = {{.image = 0, .width = 1024, .height = 256}, {.image = 2, .width = 1, .height = 1}, {3, 300, 700}};
  for (std::uint32_t cell = 0; cell < contents.sets.size(); ++cell) {
    const std::uint32_t wave = (cell / 3 * 5) % 20;
    levels.push_back({static_cast<std::uint8_t>(format::level_zero + wave),
                      cell % 7 < 4 ? format::level_zero : format::no_level,
                      cell % 5 == 0   ? format::finest_level
                      : cell % 5 == 3 ? format::coarsest_level(textures[2])
                                      : format::no_level});
  }
}

format::residency_source sample_residency::source() const {
  return {textures, pixels_per_radian, anisotropy, [this](std::uint32_t cell, std::span<std::uint8_t> out) {
            std::copy(levels[cell].begin(), levels[cell].end(), out.begin());
            return format::status::ok;
          }};
}

std::vector<std::byte> with_residency(const std::vector<std::byte>& file, const sample_residency& residency) {
  std::vector<std::byte> bytes;
  EXPECT_EQ(format::put_residency(file, residency.source(), bytes), format::status::ok);
  return bytes;
}

std::vector<std::vector<std::uint8_t>> levels_of(const format::reader& file) {
  residency_decoder decoder;
  EXPECT_EQ(decoder.open(file), format::status::ok);
  std::vector<std::vector<std::uint8_t>> out;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    EXPECT_EQ(decoder.table.decode(cell, decoder.codes, decoder.levels), format::status::ok);
    out.push_back(decoder.levels);
  }
  return out;
}

format::status use_residency(const format::reader& file) {
  residency_decoder decoder;
  if (const format::status s = decoder.open(file); s != format::status::ok) return s;
  return decoder.table.check(decoder.codes, decoder.levels);
}

}  // namespace sightcell::test
