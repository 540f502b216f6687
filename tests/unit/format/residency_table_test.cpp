#include "sightcell/format/residency_table.h"

#include <gtest/gtest.h>

#include "sightcell/format/layout.h"
#include "unit/format/caster_samples.h"
#include "unit/format/residency_samples.h"
#include "unit/format/sample_contents.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using bytes = std::vector<std::byte>;

bytes residency_file() {
  const sample_contents contents = small_contents();
  return with_residency(contents.encode(), sample_residency(contents));
}

status open_and_use_residency(const bytes& file) {
  reader opened;
  if (const status s = reader::open(file, opened); s != status::ok) return s;
  return use_residency(opened);
}

TEST(residency_table, has_what_was_written) {
  const sample_contents contents = small_contents();
  const sample_residency residency(contents);
  const bytes whole = with_residency(contents.encode(), residency);
  reader file;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  ASSERT_GT(file.cell_count(), layout::cells_per_residency_chunk) << "more than one chunk";
  EXPECT_EQ(levels_of(file), residency.levels);
  residency_table table;
  ASSERT_EQ(residency_table::open(file, table), status::ok);
  EXPECT_EQ(table.pixels_per_radian(), 1000.0f);
  EXPECT_EQ(table.anisotropy(), 16.0f);
  ASSERT_EQ(table.texture_count(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(table.texture(i), residency.textures[i]);
  bytes memory(residency_table::codes_size());
  const residency_codes* codes = nullptr;
  ASSERT_EQ(table.make_codes(memory, codes), status::ok);
  std::vector<std::uint8_t> levels(3);
  EXPECT_EQ(table.decode(file.cell_count(), codes, levels), status::argument);
  EXPECT_EQ(table.decode(0, nullptr, levels), status::argument);
  EXPECT_EQ(table.decode(0, codes, std::span(levels).first(2)), status::capacity);
  EXPECT_EQ(table.make_codes(std::span(memory).first(8), codes), status::capacity);
}

TEST(residency_table, leaves_the_rest_of_a_file_as_it_is) {
  const sample_contents contents = small_contents();
  const bytes before = with_casters(contents.encode(), sample_casters(contents));
  const bytes with = with_residency(before, sample_residency(contents));
  bytes without;
  ASSERT_EQ(remove_residency(with, without), status::ok);
  EXPECT_TRUE(without == before);
  EXPECT_TRUE(with_residency(with, sample_residency(contents)) == with);
  reader file;
  ASSERT_EQ(reader::open(before, file), status::ok);
  EXPECT_EQ(use_residency(file), status::absent);
  // A host that pages has it with the front.
  std::uint64_t front = 0, front_before = 0;
  ASSERT_EQ(reader::front_size(with, with.size(), front), status::ok);
  ASSERT_EQ(reader::front_size(before, before.size(), front_before), status::ok);
  EXPECT_EQ(front - front_before, with.size() - before.size());
}

TEST(residency_table, no_texture_and_no_cell) {
  sample_contents contents = small_contents();
  sample_residency none(contents);
  none.textures.clear();
  for (auto& levels : none.levels) levels.clear();
  EXPECT_EQ(open_and_use_residency(with_residency(contents.encode(), none)), status::ok);
  contents.cells.clear();
  contents.sets.clear();
  contents.certificate.clear();
  contents.viewpoints = {};
  EXPECT_EQ(open_and_use_residency(with_residency(contents.encode(), sample_residency(contents))), status::ok);
}

TEST(residency_table, the_writer_rejects) {
  const sample_contents contents = small_contents();
  const bytes file = contents.encode();
  const auto refused = [&](const auto& change) {
    sample_residency residency(contents);
    change(residency);
    bytes out;
    return put_residency(file, residency.source(), out);
  };
  EXPECT_EQ(refused([](auto&) {}), status::ok);
  EXPECT_EQ(refused([](auto& r) { r.pixels_per_radian = 0.0f; }), status::argument);
  EXPECT_EQ(refused([](auto& r) { r.anisotropy = 0.5f; }), status::argument);
  EXPECT_EQ(refused([](auto& r) { r.anisotropy = 17.0f; }), status::argument);
  EXPECT_EQ(refused([](auto& r) { r.textures[1].image = 0; }), status::argument);
  EXPECT_EQ(refused([](auto& r) { r.textures[1].width = 0; }), status::argument);
  EXPECT_EQ(refused([](auto& r) { r.textures[1].height = 65'537; }), status::argument);
  EXPECT_EQ(refused([](auto& r) { r.levels[0][1] = level_zero + 1; }), status::argument) << "of a single texel";
  EXPECT_EQ(refused([](auto& r) { r.textures.resize(65'537); }), status::limit);
}

TEST(residency_table, damage_is_found_where_it_is_read) {
  const bytes whole = residency_file();
  const std::size_t begin = section_offset(whole, layout::section_residency);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_residency) + 16);
  int corrupt = 0;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    bytes changed = whole;
    changed[begin + bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    EXPECT_EQ(open_and_use_residency(changed), status::checksum);
    reseal(changed);
    const status s = open_and_use_residency(changed);
    EXPECT_TRUE(s == status::ok || s == status::corrupt || s == status::limit) << bit;
    corrupt += s == status::corrupt ? 1 : 0;
  }
  EXPECT_GT(corrupt, 200);
  bytes required = whole;
  set_u32(required, section_place(required, layout::section_residency) + 4, 1);
  reseal(required);
  EXPECT_EQ(open_and_use_residency(required), status::version);
}

TEST(residency_table, bytes_that_change_later) {
  bytes whole = residency_file();
  reader file;
  residency_table table;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  ASSERT_EQ(residency_table::open(file, table), status::ok);
  bytes memory(residency_table::codes_size());
  const residency_codes* codes = nullptr;
  ASSERT_EQ(table.make_codes(memory, codes), status::ok);
  std::vector<std::uint8_t> levels(3);
  const std::size_t begin = section_offset(whole, layout::section_residency);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_residency) + 16);
  for (const int value : {0xFF, 0x55, 0x00}) {
    for (std::size_t i = layout::residency_head_size; i < size; ++i) whole[begin + i] = static_cast<std::byte>(value);
    EXPECT_NE(table.check(codes, levels), status::checksum);
  }
}

}  // namespace
