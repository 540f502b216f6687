// Every byte of a file is hostile. Each test passes the reader an exact-size heap block, so that the sanitizers detect
// an access outside, and then calls everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "random_source.h"
#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "unit/case_step.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

// A new block of exactly the file's size, at an odd address as often as at an even one.
class exact_block {
 public:
  explicit exact_block(std::span<const std::byte> bytes)
      : block_(std::make_unique<std::byte[]>(bytes.size())), size_(bytes.size()) {
    std::copy(bytes.begin(), bytes.end(), block_.get());
  }
  [[nodiscard]] std::span<std::byte> bytes() const { return {block_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> block_;
  std::size_t size_;
};

// An accepted row has only existing volumes.
void expect_volumes(const reader& file, std::uint32_t cell, const row_codes* codes, std::span<run> out,
                    std::span<std::byte> scratch) {
  row_parts parts;
  std::uint64_t next = 0;
  if (file.decode_row(cell, codes, out, scratch, parts) != status::ok) return;
  for (const run& one : parts.volumes) {
    EXPECT_GE(one.first, next);
    EXPECT_GE(one.count, 1u);
    next = std::uint64_t{one.first} + one.count + 1;
  }
  EXPECT_LE(next, std::uint64_t{file.volumes().count()} + 1);
}

// Calls all functions. An accepted row must be a set inside the scene. Returns the result of check.
status use_everything(const reader& file) {
  box b;
  draw_record d;
  certificate_record c;
  section_record s;
  row_record r;
  row_statistics sums;
  const std::unique_ptr<std::byte[]> memory = std::make_unique<std::byte[]>(file.codes_size());
  const row_codes* codes = nullptr;
  std::vector<run> out(file.row_room());
  std::vector<std::byte> scratch(file.scratch_size());
  std::vector<std::uint32_t> stored(file.polygon_count()), room(file.check_room());
  std::vector<std::uint32_t> orders(file.order_begin(file.order_count()));
  static_cast<void>(file.make_codes({memory.get(), file.codes_size()}, codes));
  for (std::uint32_t i = 0; i < file.section_count(); ++i) static_cast<void>(file.section(i, s));
  for (std::uint32_t i = 0; i < file.draw_count(); ++i) static_cast<void>(file.draw(i, d));
  for (std::uint32_t i = 0; i < file.draw_count(); ++i) static_cast<void>(file.order_of_draw(i));
  if (file.orders(orders) == status::ok) {
    for (std::uint32_t i = 0; i < file.draw_count() && file.draw(i, d) == status::ok; ++i) {
      const std::uint32_t begin = file.order_begin(file.order_of_draw(i));
      const std::uint32_t end = file.order_begin(file.order_of_draw(i) + 1);
      for (std::uint32_t k = begin; k < end && k < orders.size(); ++k) EXPECT_LT(orders[k], end - begin);
    }
  }
  if (file.source_of_stored(stored) == status::ok) {
    for (const std::uint32_t source : stored) EXPECT_LT(source, file.polygon_count());
  }
  for (std::uint32_t i = 0; i <= file.range_unit_count(); ++i) static_cast<void>(file.range_unit_begin(i));
  for (std::uint32_t i = 0; file.lattice() != nullptr && i < file.lattice()->chunk_count(); ++i)
    static_cast<void>(file.lattice()->chunk(i));
  if (file.grid() != nullptr) static_cast<void>(file.grid()->place(file.cell_count()));
  std::size_t text = 0;
  for (const char letter : file.settings()) text += letter == '{' ? 1 : 0;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    static_cast<void>(file.cell_box(cell, b));
    static_cast<void>(file.certificate(cell, c));
    if (cell % 8 == 1) static_cast<void>(file.row(cell, r));  // reads the whole chunk: slow
    std::size_t count = 0;
    if (file.decode_row(cell, codes, out, scratch, count) != status::ok) {
      EXPECT_EQ(count, 0u);
      continue;
    }
    std::uint64_t next = 0;
    for (const run& one : std::span(out).first(count)) {
      EXPECT_GE(one.first, next);
      EXPECT_GE(one.count, 1u);
      next = std::uint64_t{one.first} + one.count + 1;
    }
    EXPECT_LE(next, std::uint64_t{file.polygon_count()} + 1);
    static_cast<void>(file.count_ranges(std::span(out).first(count)));
    expect_volumes(file, cell, codes, out, scratch);
  }
  lattice_place p;
  for (std::uint32_t i = 0; i < file.volumes().count(); ++i) {
    static_cast<void>(file.volumes().place(i, p));
    if (file.volumes().volume_box(i, b)) {
      EXPECT_LT(b.min[0], b.max[0]);
    }
  }
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    const cell_chunk chunk = file.chunks().chunk_of(cell);
    EXPECT_TRUE(chunk.number < file.chunk_count() && chunk.first_cell <= cell && cell < chunk.end()) << cell;
    EXPECT_LE(chunk.end(), file.cell_count());
  }
  static_cast<void>(file.statistics(codes, out, scratch, sums));
  EXPECT_LE(text, file.settings().size());
  return file.check(codes, out, scratch, room);
}

status open_and_use(std::span<const std::byte> bytes) {
  const exact_block block(bytes);
  reader file;
  if (const status s = reader::open(block.bytes(), file); s != status::ok) return s;
  return use_everything(file);
}

status open_only(const std::vector<std::byte>& bytes) {
  reader file;
  return reader::open(bytes, file);
}

// One file of each version, of each kind of cells and of each host layout, with all sections; one with small chunks.
std::vector<std::vector<std::byte>> all_kinds() {
  sample_contents on_lattice = small_contents();
  put_in_order(on_lattice, 8);
  put_on_lattice(on_lattice);
  on_lattice.chunk_bytes = 200;
  sample_contents on_grid = tiny_contents();
  put_on_grid(on_grid);
  sample_contents merged = small_contents();
  add_draws(merged, 300, 9);
  put_in_groups(merged, 3);
  sample_contents with_volumes = tiny_contents();
  add_volumes(with_volumes, 40, 5);
  return {small_contents().encode(), on_lattice.encode(),   on_grid.encode(),
          merged.encode(),           with_volumes.encode(), golden_file("v0_small")};
}

TEST(reader_hostile, cut_at_every_length) {
  for (const auto& bytes : all_kinds()) {
    ASSERT_EQ(open_and_use(bytes), status::ok);
    for (std::size_t size = 0; size < bytes.size(); size += case_step()) {
      ASSERT_EQ(open_and_use(std::span(bytes).first(size)), status::truncated) << size;
    }
  }
}

TEST(reader_hostile, cut_at_every_length_with_a_header_that_agrees) {
  for (const auto& whole : all_kinds()) {
    for (std::size_t size = layout::header_size; size < whole.size(); size += case_step()) {
      std::vector<std::byte> bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      set_u64(bytes, layout::header_total_size, size);
      reseal(bytes);
      ASSERT_NE(open_and_use(bytes), status::ok) << size;
    }
  }
}

TEST(reader_hostile, bytes_behind_the_end) {
  auto bytes = small_contents().encode();
  bytes.push_back(std::byte{0});
  EXPECT_EQ(open_and_use(bytes), status::corrupt);
  set_u64(bytes, layout::header_total_size, bytes.size());
  reseal(bytes);
  EXPECT_EQ(open_and_use(bytes), status::corrupt);
}

TEST(reader_hostile, every_byte_flipped_is_found) {
  for (auto& bytes : all_kinds()) {
    for (std::size_t at = 0; at < bytes.size(); at += case_step()) {
      const std::byte kept = bytes[at];
      for (const int mask : {0x01, 0x80, 0xFF}) {
        bytes[at] = kept ^ static_cast<std::byte>(mask);
        ASSERT_NE(open_and_use(bytes), status::ok) << at;
      }
      bytes[at] = kept;
    }
  }
}

// With fitting checksums, the file may be rejected or be another valid file, but no access leaves its bounds.
TEST(reader_hostile, every_byte_changed_with_fitting_checksums) {
  for (const auto& whole : all_kinds()) {
    std::size_t refused = 0;
    for (std::size_t at = 0; at < whole.size(); at += case_step()) {
      for (const int mask : {0x01, 0xFF}) {
        auto bytes = whole;
        bytes[at] ^= static_cast<std::byte>(mask);
        reseal(bytes);
        refused += open_and_use(bytes) == status::ok ? 0 : 1;
      }
    }
    EXPECT_GT(refused, whole.size() / case_step() / 2);
  }
}

TEST(reader_hostile, random_damage_with_fitting_checksums) {
  random_source random(11);
  sample_contents contents = random_contents(3, {.polygons = 300, .cells = 70, .changed = 0.05});
  put_in_order(contents, 9);
  put_on_lattice(contents);
  const auto whole = contents.encode();
  for (std::size_t round = 0; round < 3000; round += case_step()) {
    auto bytes = whole;
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      // Small numbers and large ones: both ends of every comparison.
      const std::size_t at = random() % bytes.size();
      bytes[at] = static_cast<std::byte>(random() % 3 == 0 ? random() : random() % 2 * 255);
    }
    reseal(bytes);
    static_cast<void>(open_and_use(bytes));
  }
}

// The bytes of an open file change: the checks of open no longer hold.
TEST(reader_hostile, bytes_that_change_after_open) {
  random_source random(12);
  const auto kinds = all_kinds();
  for (std::size_t round = 0; round < 4500; round += case_step()) {
    const auto& whole = kinds[round % kinds.size()];
    const exact_block block(whole);
    reader file;
    ASSERT_EQ(reader::open(block.bytes(), file), status::ok);
    const bool wild = round % 10 == 0;
    for (std::size_t n = wild ? whole.size() : 1 + random() % 40; n > 0; --n) {
      block.bytes()[random() % whole.size()] = static_cast<std::byte>(random());
    }
    static_cast<void>(use_everything(file));
  }
}

TEST(reader_hostile, other_files_and_versions) {
  auto bytes = tiny_contents().encode();
  EXPECT_EQ(open_only({}), status::truncated);
  EXPECT_EQ(open_only(std::vector<std::byte>(500)), status::not_ours);
  set_u32(bytes, layout::header_version, layout::version + 1);
  EXPECT_EQ(open_only(bytes), status::version);
}

TEST(reader_hostile, sections_that_overlap_or_leave_gaps) {
  const auto whole = small_contents().encode();
  for (const std::uint32_t id : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    for (const std::int64_t step : {-64, -1, 1, 64}) {
      auto bytes = whole;
      const std::size_t place = section_place(bytes, id);
      set_u64(bytes, place + 8, get_u64(bytes, place + 8) + static_cast<std::uint64_t>(step));
      reseal(bytes);
      EXPECT_EQ(open_only(bytes), status::corrupt) << id << " " << step;
      bytes = whole;
      set_u64(bytes, place + 16, get_u64(bytes, place + 16) + static_cast<std::uint64_t>(step));
      reseal(bytes);
      EXPECT_EQ(open_only(bytes), status::corrupt) << id << " " << step;
    }
    auto bytes = whole;
    set_u64(bytes, section_place(bytes, id) + 16, std::numeric_limits<std::uint64_t>::max() - 7);
    reseal(bytes);
    EXPECT_EQ(open_only(bytes), status::corrupt) << id;
  }
}

TEST(reader_hostile, missing_and_doubled_sections) {
  const auto whole = small_contents().encode();
  for (const std::uint32_t id : {1u, 2u, 3u, 4u, 7u, 8u}) {
    auto bytes = whole;
    const std::size_t place = section_place(bytes, id);
    set_u32(bytes, place, 999);
    reseal(bytes);
    EXPECT_EQ(open_only(bytes), status::version) << id;  // unknown and required
    set_u32(bytes, place + 4, 0);
    reseal(bytes);
    EXPECT_EQ(open_only(bytes), status::corrupt) << id;  // unknown and optional, but one is missing
    bytes = whole;
    set_u32(bytes, section_place(bytes, 6), id);
    reseal(bytes);
    EXPECT_EQ(open_only(bytes), status::corrupt) << id;  // it occurs twice
  }
}

TEST(reader_hostile, unknown_optional_sections_are_skipped) {
  auto bytes = small_contents().encode();
  const std::size_t place = section_place(bytes, layout::section_settings);
  set_u32(bytes, place, 0xABCDu);
  reseal(bytes);
  EXPECT_EQ(open_and_use(bytes), status::ok);
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.settings(), "");
  // Skipped at open, but check tests its checksum too.
  bytes[get_u64(bytes, place + 8)] ^= std::byte{1};
  EXPECT_EQ(open_only(bytes), status::ok);
  EXPECT_EQ(open_and_use(bytes), status::checksum);
}

void expect_after(std::size_t at, std::uint32_t value, status expected) {
  auto bytes = small_contents().encode();
  set_u32(bytes, at, value);
  reseal(bytes);
  EXPECT_EQ(open_only(bytes), expected) << at << " " << value;
}

TEST(reader_hostile, counts_at_and_above_their_limits) {
  expect_after(layout::header_polygon_count, layout::max_polygons, status::corrupt);  // the draws have 300
  expect_after(layout::header_polygon_count, layout::max_polygons + 1, status::limit);
  expect_after(layout::header_cell_count, layout::max_cells, status::corrupt);
  expect_after(layout::header_cell_count, layout::max_cells + 1, status::limit);
  expect_after(layout::header_draw_count, layout::max_draws, status::corrupt);
  expect_after(layout::header_draw_count, layout::max_draws + 1, status::limit);
  expect_after(layout::header_section_count, layout::max_sections, status::corrupt);
  expect_after(layout::header_section_count, layout::max_sections + 1, status::limit);
  expect_after(layout::header_section_count, 0, status::corrupt);
  expect_after(layout::header_run_bound, 0xFFFFFFFFu, status::corrupt);
  expect_after(layout::header_range_bound, 0xFFFFFFFFu, status::corrupt);
  expect_after(layout::header_range_bound, 0, status::corrupt);
  expect_after(layout::header_layout, 1, status::corrupt);
  expect_after(layout::header_flags, 2, status::corrupt);
  expect_after(layout::header_list_bound, 0xFFFFFFFFu, status::corrupt);
}

TEST(reader_hostile, numbers_that_are_none) {
  for (const float bad : {std::nanf(""), -1.0f, std::numeric_limits<float>::infinity()}) {
    const auto bits = std::bit_cast<std::uint32_t>(bad);
    expect_after(layout::header_margin, bits, status::corrupt);
    expect_after(layout::header_max_pixel_error, bits, status::corrupt);
    expect_after(layout::header_confidence, bits, status::corrupt);
    expect_after(layout::header_slack, bits, status::corrupt);
  }
  expect_after(layout::header_margin, std::bit_cast<std::uint32_t>(2.0e6f), status::limit);
  const auto whole = small_contents().encode();
  const std::size_t cells = section_offset(whole, layout::section_cells) + 4;
  expect_after(cells, std::bit_cast<std::uint32_t>(std::nanf("")), status::corrupt);
  expect_after(cells, std::bit_cast<std::uint32_t>(-std::numeric_limits<float>::infinity()), status::corrupt);
  expect_after(cells, std::bit_cast<std::uint32_t>(1.0f), status::corrupt);  // min = max
}

TEST(reader_hostile, bounds_that_rows_do_not_keep) {
  auto bytes = small_contents().encode();
  set_u32(bytes, layout::header_run_bound, get_u32(bytes, layout::header_run_bound) - 1);
  reseal(bytes);
  EXPECT_EQ(open_and_use(bytes), status::corrupt);
  bytes = small_contents().encode();
  set_u32(bytes, layout::header_range_bound, get_u32(bytes, layout::header_range_bound) - 1);
  reseal(bytes);
  EXPECT_EQ(open_and_use(bytes), status::corrupt);
  bytes = small_contents().encode();
  set_u32(bytes, layout::header_list_bound, get_u32(bytes, layout::header_list_bound) - 1);
  reseal(bytes);
  EXPECT_EQ(open_and_use(bytes), status::corrupt);
}

}  // namespace
