#include "sightcell/format/caster_table.h"

#include <gtest/gtest.h>

#include "sightcell/format/layout.h"
#include "unit/format/caster_samples.h"
#include "unit/format/sample_contents.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using bytes = std::vector<std::byte>;

bytes sample_file() {
  const sample_contents contents = small_contents();
  return with_casters(contents.encode(), sample_casters(contents));
}

status open_and_use_casters(const bytes& file) {
  reader opened;
  if (const status s = reader::open(file, opened); s != status::ok) return s;
  return use_casters(opened);
}

TEST(caster_table, has_what_was_written) {
  const sample_contents contents = small_contents();
  const sample_casters casters(contents);
  const bytes whole = with_casters(contents.encode(), casters);
  reader file;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  EXPECT_EQ(casters_of(file), casters.sets);
  caster_table table;
  ASSERT_EQ(caster_table::open(file, table), status::ok);
  ASSERT_EQ(table.sun_count(), 2u);
  sun_record sun;
  ASSERT_EQ(table.sun(1, sun), status::ok);
  EXPECT_EQ(sun.from, casters.suns[1].from);
  EXPECT_EQ(sun.to, casters.suns[1].to);
  EXPECT_EQ(table.sun(2, sun), status::argument);
  certificate_record proof;
  ASSERT_EQ(table.certificate(1, 1, proof), status::ok);
  EXPECT_EQ(proof.rays, 30'001u);
  EXPECT_EQ(proof.misses, 1u);
  EXPECT_EQ(proof.upper_bound, 0.25);
  EXPECT_EQ(table.certificate(file.cell_count(), 0, proof), status::argument);
}

TEST(caster_table, leaves_the_rest_of_a_file_as_it_is) {
  const bytes before = small_contents().encode();
  const bytes with = sample_file();
  bytes without;
  ASSERT_EQ(remove_casters(with, without), status::ok);
  EXPECT_TRUE(without == before);
  EXPECT_TRUE(with_casters(with, sample_casters(small_contents())) == with);
  reader file;
  ASSERT_EQ(reader::open(before, file), status::ok);
  EXPECT_EQ(use_casters(file), status::absent);
  // A host that pages does not load the casters with the front.
  std::uint64_t front = 0, front_before = 0;
  ASSERT_EQ(reader::front_size(with, with.size(), front), status::ok);
  ASSERT_EQ(reader::front_size(before, before.size(), front_before), status::ok);
  EXPECT_EQ(front, front_before + layout::section_record_size);
}

TEST(caster_table, the_writer_rejects) {
  const sample_contents contents = small_contents();
  const bytes file = contents.encode();
  const auto refused = [&](const auto& change) {
    sample_casters casters(contents);
    change(casters);
    bytes out;
    return put_casters(file, casters.source(), out);
  };
  EXPECT_EQ(refused([](auto&) {}), status::ok);
  EXPECT_EQ(refused([](auto& c) { c.suns.clear(); }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.suns[0].from = {0.0f, 2.0f, 0.0f}; }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.suns[0].to = {0.0f, -1.0f, 0.0f}; }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.certificate.pop_back(); }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.certificate[0].misses = 40'000; }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.sets[0] = {2, 1}; }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.sets[0] = {0xFFFFFF00u}; }), status::argument);
}

TEST(caster_table, damage_is_found_where_it_is_read) {
  const bytes whole = sample_file();
  const std::size_t begin = section_offset(whole, layout::section_casters);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_casters) + 16);
  int corrupt = 0;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    bytes changed = whole;
    changed[begin + bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    EXPECT_EQ(open_and_use_casters(changed), status::checksum);
    reseal(changed);
    const status s = open_and_use_casters(changed);
    EXPECT_TRUE(s == status::ok || s == status::corrupt || s == status::limit) << bit;
    corrupt += s == status::corrupt ? 1 : 0;
  }
  EXPECT_GT(corrupt, 300);
  bytes required = whole;
  set_u32(required, section_place(required, layout::section_casters) + 4, 1);
  reseal(required);
  EXPECT_EQ(open_and_use_casters(required), status::version);
}

TEST(caster_table, bytes_that_change_later) {
  bytes whole = sample_file();
  reader file;
  caster_table table;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  ASSERT_EQ(caster_table::open(file, table), status::ok);
  bytes memory(file.codes_size()), scratch(table.scratch_size());
  std::vector<run> runs(table.run_bound());
  const row_codes* codes = nullptr;
  ASSERT_EQ(table.make_codes(memory, codes), status::ok);
  const std::size_t begin = section_offset(whole, layout::section_casters);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_casters) + 16);
  for (const int value : {0xFF, 0x55, 0x00}) {
    for (std::size_t i = 12; i < size; ++i) whole[begin + i] = static_cast<std::byte>(value);
    EXPECT_NE(table.check(codes, runs, scratch), status::checksum);
    certificate_record proof;
    static_cast<void>(table.certificate(0, 0, proof));
  }
}

}  // namespace
