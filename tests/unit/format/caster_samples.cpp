#include "caster_samples.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sightcell::test {
namespace {

struct caster_decoder {
  format::caster_table table;
  std::vector<std::byte> memory, scratch;
  std::vector<format::run> runs;
  const format::row_codes* codes = nullptr;

  format::status open(const format::reader& file) {
    if (const format::status s = format::caster_table::open(file, table); s != format::status::ok) return s;
    memory.resize(file.codes_size());
    scratch.resize(table.scratch_size());
    runs.resize(table.run_bound());
    return table.make_codes(memory, codes);
  }
};

}  // namespace

sample_casters::sample_casters(const sample_contents& contents) {
  suns = {{{0.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f}}, {{0.6f, 0.8f, 0.0f}, {0.0f, 0.8f, -0.6f}}};
  for (std::uint32_t cell = 0; cell < contents.sets.size(); ++cell) {
    const auto& seen = contents.sets[cell];
    for (std::uint32_t sun = 0; sun < suns.size(); ++sun) {
      std::vector<std::uint32_t>& set = sets.emplace_back();
      for (std::uint32_t polygon = 0; polygon < contents.facts.polygon_count; ++polygon) {
        const bool caster = (polygon / 3 + cell / 4 + sun) % 4 == 0;
        if (caster && !std::binary_search(seen.begin(), seen.end(), polygon)) set.push_back(polygon);
      }
      certificate.push_back(
          {.cell = cell, .rays = 30'000 + cell, .misses = sun, .upper_bound = 0.25, .confidence = 0.5, .seed = 7});
    }
  }
}

format::caster_source sample_casters::source() const {
  return {suns,
          [this](std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& set) {
            set = sets[cell * suns.size() + sun];
            return format::status::ok;
          },
          certificate};
}

std::vector<std::byte> with_casters(const std::vector<std::byte>& file, const sample_casters& casters) {
  std::vector<std::byte> bytes;
  EXPECT_EQ(format::put_casters(file, casters.source(), bytes), format::status::ok);
  return bytes;
}

std::vector<std::vector<std::uint32_t>> casters_of(const format::reader& file) {
  caster_decoder decoder;
  EXPECT_EQ(decoder.open(file), format::status::ok);
  std::vector<std::uint32_t> sources(file.polygon_count());
  EXPECT_EQ(file.source_of_stored(sources), format::status::ok);
  std::vector<std::vector<std::uint32_t>> sets;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    for (std::uint32_t sun = 0; sun < decoder.table.sun_count(); ++sun) {
      std::size_t count = 0;
      EXPECT_EQ(decoder.table.decode(cell, sun, decoder.codes, decoder.runs, decoder.scratch, count),
                format::status::ok);
      auto& set = sets.emplace_back();
      for (std::size_t i = 0; i < count; ++i) {
        for (std::uint32_t k = 0; k < decoder.runs[i].count; ++k) set.push_back(sources[decoder.runs[i].first + k]);
      }
      std::sort(set.begin(), set.end());
    }
  }
  return sets;
}

format::status use_casters(const format::reader& file) {
  caster_decoder decoder;
  if (const format::status s = decoder.open(file); s != format::status::ok) return s;
  return decoder.table.check(decoder.codes, decoder.runs, decoder.scratch);
}

}  // namespace sightcell::test
