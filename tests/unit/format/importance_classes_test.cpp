#include "sightcell/format/importance_classes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <memory>

#include "importance_samples.h"
#include "random_source.h"
#include "sample_contents.h"
#include "sightcell/format/importance_writer.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "unit/case_step.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using bytes = std::vector<std::byte>;

reader opened(const bytes& file) {
  reader out;
  EXPECT_EQ(reader::open(file, out), status::ok);
  return out;
}

sample_contents some_contents() {
  sample_contents contents = random_contents(5, {.polygons = 900, .cells = 150, .visible = 0.3});
  put_in_order(contents, 4);
  return contents;
}

std::uint64_t section_size(const bytes& file) {
  return get_u64(file, section_place(file, layout::section_importance) + 16);
}

TEST(importance_classes, come_back) {
  for (const bool merged : {false, true}) {
    sample_contents contents = some_contents();
    if (merged) put_in_groups(contents, 4);
    const bytes file = with_importance(contents.encode(), sample_class);
    const reader in = opened(file);
    EXPECT_EQ(check_all(in), status::ok);
    for (std::uint32_t cell = 0; cell < in.cell_count(); ++cell) {
      std::vector<std::uint8_t> expected;
      for (const std::uint32_t polygon : contents.sets[cell]) expected.push_back(sample_class(cell, polygon));
      EXPECT_EQ(classes_of(in, cell), expected) << cell;
    }
  }
}

TEST(importance_classes, change_nothing_else_of_a_file) {
  const bytes without = some_contents().encode();
  const bytes with = with_importance(without, sample_class);
  EXPECT_FALSE(opened(without).has_importance());
  EXPECT_TRUE(opened(with).has_importance());
  bytes again;
  ASSERT_EQ(remove_importance(with, again), status::ok);
  EXPECT_TRUE(again == without);
  ASSERT_EQ(remove_importance(without, again), status::ok);
  EXPECT_TRUE(again == without);
  // Replaces what was there.
  const bytes other = with_importance(without, [](std::uint32_t, std::uint32_t) { return std::uint8_t{3}; });
  EXPECT_TRUE(with_importance(other, sample_class) == with);
  importance_classes none;
  EXPECT_EQ(opened(without).importance(none), status::argument);
}

// At most a bit per polygon where all are equal, none for the last class, and a few bytes per cell.
TEST(importance_classes, are_small_where_they_follow_from_those_before) {
  const sample_contents contents = some_contents();
  std::size_t polygons = 0;
  for (const auto& set : contents.sets) polygons += set.size();
  const bytes alike = with_importance(contents.encode(), [](std::uint32_t, std::uint32_t) { return std::uint8_t{3}; });
  EXPECT_LE(section_size(alike), polygons / 8 + 4 * contents.sets.size() + 100);
  const bytes unknown =
      with_importance(contents.encode(), [](std::uint32_t, std::uint32_t) { return least_important; });
  EXPECT_LE(section_size(unknown), 6 * contents.sets.size() + 100);
}

// Counts whose best codes would be longer than the decoder accepts.
TEST(importance_classes, that_are_rare_have_short_codes_too) {
  sample_contents contents = random_contents(5, {.polygons = 70000, .draws = 1, .cells = 1, .visible = 0.9});
  contents.sets[0].clear();
  for (std::uint32_t i = 0; i < 70000; ++i) contents.sets[0].push_back(i);
  const auto rare = [](std::uint32_t, std::uint32_t polygon) {
    // Class k after class 15 once in 2^(k + 1) polygons.
    const auto k = static_cast<std::uint32_t>(std::countr_zero(polygon / 2 + 1));
    return static_cast<std::uint8_t>(polygon % 2 == 0 ? 15 : std::min(k, 14u));
  };
  const bytes file = with_importance(contents.encode(), rare);
  EXPECT_EQ(check_all(opened(file)), status::ok);
  const auto classes = classes_of(opened(file), 0);
  for (std::uint32_t polygon = 0; polygon < 70000; ++polygon) ASSERT_EQ(classes[polygon], rare(0, polygon));
}

TEST(importance_classes, of_empty_sets_or_no_cells) {
  sample_contents blind = tiny_contents();
  for (auto& set : blind.sets) set.clear();
  const bytes file = with_importance(blind.encode(), sample_class);
  EXPECT_EQ(check_all(opened(file)), status::ok);
  EXPECT_TRUE(classes_of(opened(file), 1).empty());
  sample_contents none = tiny_contents();
  none.cells.clear();
  none.sets.clear();
  EXPECT_EQ(check_all(opened(with_importance(none.encode(), sample_class))), status::ok);
}

TEST(importance_writer, refuses_what_is_none) {
  const bytes file = tiny_contents().encode();  // cells of four polygons and one
  const auto put = [&](const bytes& in, std::vector<std::uint8_t> first, status answer = status::ok) {
    bytes out{std::byte{7}};
    const status s = put_importance(in, {[&](std::uint32_t cell, std::vector<std::uint8_t>& classes) {
                                      classes = cell == 0 ? first : std::vector<std::uint8_t>{1};
                                      return answer;
                                    }},
                                    out);
    EXPECT_TRUE(s == status::ok || out == bytes{std::byte{7}});
    return s;
  };
  EXPECT_EQ(put(file, {0, 1, 2, 15}), status::ok);
  EXPECT_EQ(put(file, {0, 1, 2, 16}), status::argument);
  EXPECT_EQ(put(file, {0, 1, 2}), status::argument);
  EXPECT_EQ(put(file, {0, 1, 2, 3, 4}), status::argument);
  EXPECT_EQ(put(file, {0, 1, 2, 15}, status::io), status::io);
  EXPECT_EQ(put(golden_file("v0_tiny"), {0, 1, 2, 15}), status::version);
  EXPECT_EQ(put({}, {0, 1, 2, 15}), status::truncated);
}

TEST(importance_classes, decode_needs_existing_cells_and_polygons) {
  const bytes file = with_importance(tiny_contents().encode(), sample_class);
  importance_classes all;
  ASSERT_EQ(opened(file).importance(all), status::ok);
  std::vector<std::uint8_t> out(4);
  EXPECT_EQ(all.decode(0, out), status::ok);
  EXPECT_EQ(all.decode(2, out), status::argument);
  EXPECT_EQ(all.check_chunk(1), status::argument);
  out.resize(64);
  EXPECT_EQ(all.decode(0, out), status::corrupt);
  EXPECT_EQ(importance_classes().decode(0, {}), status::argument);
}

// --- every byte is hostile

bytes hostile_file() {
  return with_importance(small_contents().encode(), sample_class);  // 67 cells in two chunks
}

std::unique_ptr<std::byte[]> exact(const bytes& file) {
  auto block = std::make_unique<std::byte[]>(file.size());
  std::copy(file.begin(), file.end(), block.get());
  return block;
}

// The importance is the only damage of the file. A host that does not use it does not notice.
status check_importance(const bytes& file) {
  const auto block = exact(file);
  reader in;
  EXPECT_EQ(reader::open({block.get(), file.size()}, in), status::ok);
  static_cast<void>(use_importance(in));
  return check_all(in);
}

TEST(importance_hostile, cut_at_every_length) {
  const bytes whole = hostile_file();
  const std::size_t record = section_place(whole, layout::section_importance);
  for (std::uint64_t size = 0; size < section_size(whole); size += case_step()) {
    bytes file = whole;
    file.resize(section_offset(whole, layout::section_importance) + size);
    set_u64(file, record + 16, size);
    set_u64(file, layout::header_total_size, file.size());
    reseal_importance(file);
    ASSERT_NE(check_importance(file), status::ok) << size;
  }
}

TEST(importance_hostile, every_byte_flipped_is_found) {
  const bytes whole = hostile_file();
  const std::size_t begin = section_offset(whole, layout::section_importance);
  for (std::size_t at = begin; at < whole.size(); at += case_step()) {
    bytes file = whole;
    file[at] ^= std::byte{0x10};
    ASSERT_EQ(check_importance(file), status::checksum) << at;
    reseal(file);  // the section's checksum fits, those inside it do not
    ASSERT_NE(check_importance(file), status::ok) << at;
  }
}

TEST(importance_hostile, every_byte_changed_with_fitting_checksums) {
  const bytes whole = hostile_file();
  const std::size_t begin = section_offset(whole, layout::section_importance);
  std::size_t refused = 0, tried = 0;
  for (std::size_t at = begin; at < whole.size(); at += case_step()) {
    for (const int mask : {0x01, 0x80, 0xFF}) {
      bytes file = whole;
      file[at] ^= static_cast<std::byte>(mask);
      reseal_importance(file);
      refused += check_importance(file) == status::ok ? 0 : 1;
      ++tried;
    }
  }
  EXPECT_GT(refused, tried / 10);
}

TEST(importance_hostile, bytes_that_change_after_open) {
  random_source random(13);
  const bytes whole = hostile_file();
  const std::size_t begin = section_offset(whole, layout::section_importance);
  for (std::size_t round = 0; round < 1000; round += case_step()) {
    const auto block = exact(whole);
    reader in;
    importance_classes all;
    ASSERT_EQ(reader::open({block.get(), whole.size()}, in), status::ok);
    ASSERT_EQ(in.importance(all), status::ok);
    for (std::size_t n = 1 + random() % 40; n > 0; --n) {
      block[begin + random() % (whole.size() - begin)] = static_cast<std::byte>(random());
    }
    std::vector<std::uint8_t> classes(300);
    for (std::uint32_t cell = 0; cell < in.cell_count(); ++cell) {
      static_cast<void>(all.check_chunk(in.chunk_of(cell)));
      if (all.decode(cell, std::span(classes).first(random() % 300)) != status::ok) continue;
      for (const std::uint8_t one : classes) ASSERT_LT(one, importance_class_count);
    }
  }
}

TEST(importance_hostile, sections_that_leave_gaps_or_are_required) {
  const bytes whole = hostile_file();
  const std::size_t record = section_place(whole, layout::section_importance);
  reader unused;
  bytes file = whole;
  set_u64(file, record + 16, get_u64(file, record + 16) - 1);
  reseal(file);
  EXPECT_EQ(reader::open(file, unused), status::corrupt);
  file = whole;
  set_u32(file, record + 4, layout::section_required);
  reseal(file);
  EXPECT_EQ(reader::open(file, unused), status::version);
}

}  // namespace
