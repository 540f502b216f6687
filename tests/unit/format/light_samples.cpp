#include "light_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace sightcell::test {
namespace {

constexpr std::uint32_t light_count = 10;  // bits of two bytes

struct light_decoder {
  format::light_table table;
  std::vector<std::byte> memory, scratch;
  std::vector<format::run> runs;
  const format::row_codes* codes = nullptr;

  format::status open(const format::reader& file) {
    if (const format::status s = format::light_table::open(file, table); s != format::status::ok) return s;
    memory.resize(file.codes_size());
    scratch.resize(table.sets().scratch_size());
    runs.resize(table.sets().run_bound());
    return table.sets().make_codes(memory, codes);
  }
};

}  // namespace

sample_lights::sample_lights(const sample_contents& contents) {
  for (std::uint32_t i = 0; i < light_count; ++i) {
    const auto number = static_cast<float>(i);
    lights.push_back({.node = 3 * i + 1,
                      .position = {number, 2.5f, -number},
                      .direction = {0.0f, i % 2 == 0 ? -1.0f : 0.6f, i % 2 == 0 ? 0.0f : 0.8f},
                      .range = i % 3 == 0 ? std::numeric_limits<float>::infinity() : 1.0f + number,
                      .cone = i % 2 == 0 ? 0.0f : 0.25f * number / 2.0f});
    std::vector<std::uint32_t>& set = sets.emplace_back();
    for (std::uint32_t polygon = 0; polygon < contents.facts.polygon_count && i != 4; ++polygon)
      if (i == 9 || (polygon / 3 + i) % 5 == 0) set.push_back(polygon);
    certificate.push_back(
        {.cell = i, .rays = 20'000 + i, .misses = i % 2, .upper_bound = 0.125, .confidence = 0.5, .seed = 9});
  }
  for (const std::vector<std::uint32_t>& seen : contents.sets) {
    std::vector<bool>& own = touching.emplace_back();
    for (const std::vector<std::uint32_t>& set : sets)
      own.push_back(std::find_first_of(set.begin(), set.end(), seen.begin(), seen.end()) != set.end());
  }
}

format::light_source sample_lights::source() const {
  return {lights, format::sets_of(sets),
          [this](std::uint32_t cell, std::uint32_t light) -> bool { return touching[cell][light]; }, certificate};
}

std::vector<std::byte> with_lights(const std::vector<std::byte>& file, const sample_lights& lights) {
  std::vector<std::byte> bytes;
  EXPECT_EQ(format::put_lights(file, lights.source(), bytes), format::status::ok);
  return bytes;
}

std::vector<std::vector<std::uint32_t>> sets_of_lights(const format::reader& file) {
  light_decoder decoder;
  EXPECT_EQ(decoder.open(file), format::status::ok);
  std::vector<std::uint32_t> sources(file.polygon_count());
  EXPECT_EQ(file.source_of_stored(sources), format::status::ok);
  std::vector<std::vector<std::uint32_t>> sets;
  for (std::uint32_t light = 0; light < decoder.table.light_count(); ++light) {
    std::size_t count = 0;
    EXPECT_EQ(decoder.table.sets().decode(light, decoder.codes, decoder.runs, decoder.scratch, count),
              format::status::ok);
    auto& set = sets.emplace_back();
    for (std::size_t i = 0; i < count; ++i)
      for (std::uint32_t k = 0; k < decoder.runs[i].count; ++k) set.push_back(sources[decoder.runs[i].first + k]);
    std::sort(set.begin(), set.end());
  }
  return sets;
}

format::status use_lights(const format::reader& file) {
  light_decoder decoder;
  if (const format::status s = decoder.open(file); s != format::status::ok) return s;
  format::light_record light;
  for (std::uint32_t i = 0; i < decoder.table.light_count(); ++i) {
    if (const format::status s = decoder.table.light(i, light); s != format::status::ok) return s;
    static_cast<void>(decoder.table.touches(0, i));
  }
  return decoder.table.sets().check(decoder.codes, decoder.runs, decoder.scratch);
}

}  // namespace sightcell::test
