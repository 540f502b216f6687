#include "sightcell/format/light_table.h"

#include <gtest/gtest.h>

#include <limits>

#include "sightcell/format/layout.h"
#include "unit/format/light_samples.h"
#include "unit/format/sample_contents.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using bytes = std::vector<std::byte>;

bytes lit_file() {
  const sample_contents contents = small_contents();
  return with_lights(contents.encode(), sample_lights(contents));
}

status open_and_use_lights(const bytes& file) {
  reader opened;
  if (const status s = reader::open(file, opened); s != status::ok) return s;
  return use_lights(opened);
}

TEST(light_table, has_what_was_written) {
  const sample_contents contents = small_contents();
  const sample_lights lights(contents);
  const bytes whole = with_lights(contents.encode(), lights);
  reader file;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  EXPECT_EQ(sets_of_lights(file), lights.sets);
  light_table table;
  ASSERT_EQ(light_table::open(file, table), status::ok);
  ASSERT_EQ(table.light_count(), 10u);
  light_record light;
  for (std::uint32_t i = 0; i < 10; ++i) {
    ASSERT_EQ(table.light(i, light), status::ok);
    EXPECT_EQ(light, lights.lights[i]) << i;
  }
  EXPECT_EQ(table.light(10, light), status::argument);
  certificate_record proof;
  ASSERT_EQ(table.sets().certificate(3, 3, proof), status::ok);
  EXPECT_EQ(proof.rays, 20'003u);
  EXPECT_EQ(proof.misses, 1u);
  EXPECT_EQ(proof.upper_bound, 0.125);
  EXPECT_EQ(table.sets().certificate(10, 0, proof), status::argument);
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(table.touches(cell, i), lights.touching[cell][i]) << cell;
    EXPECT_FALSE(table.touches(cell, 10));
  }
  EXPECT_FALSE(table.touches(file.cell_count(), 9));
}

TEST(light_table, leaves_the_rest_of_a_file_as_it_is) {
  const bytes before = small_contents().encode();
  const bytes with = lit_file();
  bytes without;
  ASSERT_EQ(remove_lights(with, without), status::ok);
  EXPECT_TRUE(without == before);
  EXPECT_TRUE(with_lights(with, sample_lights(small_contents())) == with);
  reader file;
  ASSERT_EQ(reader::open(before, file), status::ok);
  EXPECT_EQ(use_lights(file), status::absent);
  // A host that pages does not load the lights with the front.
  std::uint64_t front = 0, front_before = 0;
  ASSERT_EQ(reader::front_size(with, with.size(), front), status::ok);
  ASSERT_EQ(reader::front_size(before, before.size(), front_before), status::ok);
  EXPECT_EQ(front, front_before + layout::section_record_size);
}

TEST(light_table, the_writer_rejects) {
  const sample_contents contents = small_contents();
  const bytes file = contents.encode();
  const auto refused = [&](const auto& change) {
    sample_lights lights(contents);
    change(lights);
    bytes out;
    return put_lights(file, lights.source(), out);
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(refused([](auto&) {}), status::ok);
  EXPECT_EQ(refused([](auto& l) { l.lights.clear(), l.sets.clear(), l.certificate.clear(); }), status::argument);
  EXPECT_EQ(refused([](auto& l) { l.lights[0].position[1] = infinity; }), status::argument);
  EXPECT_EQ(refused([](auto& l) { l.lights[0].direction = {0.0f, -2.0f, 0.0f}; }), status::argument);
  for (const float range : {0.0f, -1.0f, nan})
    EXPECT_EQ(refused([&](auto& l) { l.lights[0].range = range; }), status::argument) << range;
  for (const float cone : {-0.1f, 1.6f, nan})
    EXPECT_EQ(refused([&](auto& l) { l.lights[0].cone = cone; }), status::argument) << cone;
  EXPECT_EQ(refused([](auto& l) { l.certificate.pop_back(); }), status::argument);
  EXPECT_EQ(refused([](auto& l) { l.certificate[0].misses = 40'000; }), status::argument);
  EXPECT_EQ(refused([](auto& l) { l.sets.pop_back(); }), status::argument);
  EXPECT_EQ(refused([](auto& l) { l.sets[0] = {2, 1}; }), status::argument);
  EXPECT_EQ(refused([](auto& l) { l.sets[0] = {0xFFFFFF00u}; }), status::argument);
}

TEST(light_table, damage_is_found_where_it_is_read) {
  const bytes whole = lit_file();
  const std::size_t begin = section_offset(whole, layout::section_lights);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_lights) + 16);
  int corrupt = 0;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    bytes changed = whole;
    changed[begin + bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    EXPECT_EQ(open_and_use_lights(changed), status::checksum);
    reseal(changed);
    const status s = open_and_use_lights(changed);
    EXPECT_TRUE(s == status::ok || s == status::corrupt || s == status::limit) << bit;
    corrupt += s == status::corrupt ? 1 : 0;
  }
  EXPECT_GT(corrupt, 300);
  bytes fill = whole;  // a bit behind the last light of cell 0
  fill[begin + layout::lights_head_size + 10 * layout::light_record_size + 1] |= std::byte{0x04};
  reseal(fill);
  EXPECT_EQ(open_and_use_lights(fill), status::corrupt);
  bytes required = whole;
  set_u32(required, section_place(required, layout::section_lights) + 4, 1);
  reseal(required);
  EXPECT_EQ(open_and_use_lights(required), status::version);
}

TEST(light_table, bytes_that_change_later) {
  bytes whole = lit_file();
  reader file;
  light_table table;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  ASSERT_EQ(light_table::open(file, table), status::ok);
  bytes memory(file.codes_size()), scratch(table.sets().scratch_size());
  std::vector<run> runs(table.sets().run_bound());
  const row_codes* codes = nullptr;
  ASSERT_EQ(table.sets().make_codes(memory, codes), status::ok);
  const std::size_t begin = section_offset(whole, layout::section_lights);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_lights) + 16);
  for (const int value : {0xFF, 0x55, 0x00}) {
    for (std::size_t i = 12; i < size; ++i) whole[begin + i] = static_cast<std::byte>(value);
    EXPECT_NE(table.sets().check(codes, runs, scratch), status::checksum);
    light_record light;
    static_cast<void>(table.light(0, light));
    static_cast<void>(table.touches(0, 9));
  }
}

}  // namespace
