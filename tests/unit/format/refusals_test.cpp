// Rejections that no damaged file of tests/golden can show: files that are too large for it, files of version 0, too
// little memory, and wrong calls.
#include <gtest/gtest.h>

#include <array>
#include <span>

#include "rank_difference.h"
#include "row_chunk.h"
#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using bytes = std::vector<std::byte>;

status opened(const bytes& file_bytes) {
  reader file;
  return reader::open(file_bytes, file);
}

// Changes the size of a section at its end; the sections after it move.
bytes resized(const bytes& whole, std::uint32_t id, std::int64_t more) {
  bytes out = whole;
  const std::size_t record = section_place(out, id);
  const std::uint64_t begin = get_u64(out, record + 8);
  const std::uint64_t size = get_u64(out, record + 16);
  const auto end = out.begin() + static_cast<std::ptrdiff_t>(begin + size);
  if (more > 0) {
    out.insert(end, static_cast<std::size_t>(more), std::byte{' '});
  } else {
    out.erase(end + static_cast<std::ptrdiff_t>(more), end);
  }
  set_u64(out, record + 16, size + static_cast<std::uint64_t>(more));
  set_u64(out, layout::header_total_size, out.size());
  for (std::size_t i = 0; i < get_u32(out, layout::header_section_count); ++i) {
    const std::size_t other = layout::header_size + i * layout::section_record_size + 8;
    if (get_u64(out, other) > begin) set_u64(out, other, get_u64(out, other) + static_cast<std::uint64_t>(more));
  }
  reseal(out);
  return out;
}

TEST(refusals, settings_above_the_limit) {
  sample_contents contents = tiny_contents();
  contents.settings = " ";
  const bytes whole = contents.encode();
  EXPECT_EQ(opened(resized(whole, layout::section_settings, layout::max_settings_size - 1)), status::ok);
  EXPECT_EQ(opened(resized(whole, layout::section_settings, layout::max_settings_size)), status::limit);
}

TEST(refusals, version_0_sections_of_another_size) {
  const bytes whole = golden_file("v0_small");
  ASSERT_EQ(opened(whole), status::ok);
  for (const std::uint32_t id : {layout::section_draws, layout::section_cells, layout::section_row_directory,
                                 layout::section_certificate, layout::section_rows}) {
    EXPECT_EQ(opened(resized(whole, id, 8)), status::corrupt) << id;
    EXPECT_EQ(opened(resized(whole, id, -8)), status::corrupt) << id;
  }
  EXPECT_EQ(opened(resized(whole, layout::section_settings, 8)), status::ok);
}

TEST(refusals, version_0_records) {
  const bytes whole = golden_file("v0_small");
  const auto refused = [&](std::uint32_t id, std::size_t at, std::uint32_t value) {
    bytes damaged = whole;
    set_u32(damaged, section_offset(damaged, id) + at, value);
    reseal(damaged);
    EXPECT_EQ(opened(damaged), status::corrupt) << id << " at " << at;
  };
  refused(layout::section_draws, 20, 1);        // a draw group
  refused(layout::section_draws, 24, 1);        // first source is not first stored
  refused(layout::section_draws, 28, 1000);     // polygons leave the scene
  refused(layout::section_certificate, 12, 1);  // more misses than rays
  const std::size_t rows = 2 * layout::chunk_record_size;
  refused(layout::section_row_directory, rows, 1u << 20);      // a row begins after its chunk
  refused(layout::section_row_directory, rows + 4, 1u << 20);  // and ends there
  refused(layout::section_row_directory, rows + 4, 0);         // or has no bytes
}

// A file of version 0 with one record of the row directory, or the bytes of a row, changed.
class rows_of_version_0 {
 public:
  explicit rows_of_version_0(const char* name = "v0_small") : file_(golden_file(name)) {}
  [[nodiscard]] std::size_t record(std::uint32_t cell) const {
    const std::size_t chunks = get(layout::header_cell_count) / layout::cells_per_block + 1;
    return section_offset(file_, layout::section_row_directory) + chunks * layout::chunk_record_size +
           layout::v0_row_record_size * cell;
  }
  [[nodiscard]] std::uint32_t get(std::size_t at) const { return get_u32(file_, at); }
  void set(std::size_t at, std::uint32_t value) { set_u32(file_, at, value); }
  void put_row(std::uint32_t cell, std::initializer_list<unsigned> row) {
    ASSERT_LE(row.size(), get(record(cell) + 4));
    const std::size_t chunk = section_offset(file_, layout::section_row_directory) +
                              cell / layout::cells_per_block * layout::chunk_record_size;
    std::size_t at = section_offset(file_, layout::section_rows) + get(chunk) + get(record(cell));
    for (const unsigned byte : row) file_[at++] = static_cast<std::byte>(byte);
    set(record(cell) + 4, static_cast<std::uint32_t>(row.size()));
  }
  // The next byte of the first chunk that is 0.
  [[nodiscard]] std::uint32_t zero_byte_behind(std::uint32_t place) const {
    const std::size_t rows = section_offset(file_, layout::section_rows);
    while (file_.at(rows + place) != std::byte{0}) ++place;
    return place;
  }
  [[nodiscard]] status decode(std::uint32_t cell) {
    reseal(file_);
    reader file;
    status s = reader::open(file_, file);
    EXPECT_EQ(s, status::ok);
    if (s == status::ok) decode_set(file, cell, s);
    return s;
  }
  [[nodiscard]] status check() {
    reseal(file_);
    reader file;
    EXPECT_EQ(reader::open(file_, file), status::ok);
    return check_all(file);
  }

 private:
  bytes file_;
};

TEST(refusals, version_0_rows) {
  const auto outcome = [](std::uint32_t cell, std::initializer_list<unsigned> row) {
    rows_of_version_0 rows;
    rows.put_row(cell, row);
    return rows.decode(cell);
  };
  EXPECT_EQ(outcome(0, {2, 0xAB, 2, 0}), status::ok);           // polygon 299
  EXPECT_EQ(outcome(0, {2, 0xAB, 2, 1}), status::corrupt);      // and 300
  EXPECT_EQ(outcome(0, {0x80}), status::corrupt);               // no whole number
  EXPECT_EQ(outcome(0, {1, 11, 0, 0}), status::ok);             // as cell 11, whose set is empty
  EXPECT_EQ(outcome(0, {3, 11, 0, 2, 0, 0}), status::corrupt);  // removes what the reference does not have
  // The last of three cells of its chunk, as the first one and as one that does not exist.
  EXPECT_EQ(outcome(66, {1, 0, 0, 0}), status::ok);
  EXPECT_EQ(outcome(66, {1, 3, 0, 0}), status::corrupt);
}

TEST(refusals, version_0_rows_that_do_not_fill_their_chunk) {
  const auto outcome = [](std::uint32_t cell, int later, int longer) {
    rows_of_version_0 rows;
    const std::size_t at = rows.record(cell);
    rows.set(at, rows.get(at) + static_cast<std::uint32_t>(later));
    rows.set(at + 4, rows.get(at + 4) + static_cast<std::uint32_t>(longer));
    return rows.check();
  };
  EXPECT_EQ(outcome(0, 0, 0), status::ok);
  EXPECT_EQ(outcome(0, 1, -1), status::corrupt);   // a gap before it
  EXPECT_EQ(outcome(20, 0, -1), status::corrupt);  // shared with another, but not whole

  // A row without polygons is one byte, 0. This leaves bytes after the last row of the chunk.
  rows_of_version_0 shorter("v0_tiny");
  shorter.put_row(1, {0});
  EXPECT_EQ(shorter.decode(1), status::ok);
  EXPECT_EQ(shorter.check(), status::corrupt);
  // And cell 20, whose row is that of another cell, may not have one from the middle of a third.
  rows_of_version_0 inside;
  const std::uint32_t zero = inside.zero_byte_behind(inside.get(inside.record(0)) + 1);
  inside.set(inside.record(20), zero);
  inside.set(inside.record(20) + 4, 1);
  EXPECT_EQ(inside.decode(20), status::ok);
  EXPECT_EQ(inside.check(), status::corrupt);
}

// Draws without polygons that are equal in all columns take no bit of the table, and a reader needs one for each. The
// writer does not write a file that the reader would reject.
TEST(refusals, more_draws_alike_than_bytes_have_bits) {
  sample_contents contents;
  contents.orders = {{}};
  contents.draws.assign(8 * 8 * layout::draw_columns, {});
  contents.order_of_draw.assign(contents.draws.size(), 0);
  EXPECT_EQ(opened(contents.encode()), status::ok);
  contents.draws.emplace_back();
  contents.order_of_draw.push_back(0);
  bytes out;
  EXPECT_EQ(encode(contents.view(), out), status::limit);
  contents.draws.back().node = 1;
  EXPECT_EQ(opened(contents.encode()), status::ok);
}

// Memory for all that decoding needs, of which one part may be too small.
struct room {
  explicit room(const reader& file)
      : code_memory(file.codes_size() / 8),
        row(file.run_bound()),
        scratch(file.scratch_size() / 4),
        stored(file.polygon_count()) {
    EXPECT_EQ(file.make_codes(std::as_writable_bytes(std::span(code_memory)), codes), status::ok);
  }
  [[nodiscard]] std::span<std::byte> scratch_bytes() { return std::as_writable_bytes(std::span(scratch)); }
  std::vector<std::uint64_t> code_memory;
  const row_codes* codes = nullptr;
  std::vector<run> row;
  std::vector<std::uint32_t> scratch;
  std::vector<std::uint32_t> stored;
};

TEST(refusals, too_little_memory) {
  const bytes whole = small_contents().encode();
  reader file;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  room all(file);
  row_statistics sums;
  std::size_t count = 0;
  const std::span<run> row = all.row;
  const std::span<std::byte> scratch = all.scratch_bytes();
  const std::span<std::uint32_t> stored = all.stored;
  const auto less = [](auto span) { return span.first(span.size() - 1); };
  EXPECT_EQ(file.check(all.codes, row, scratch, stored), status::ok);
  EXPECT_EQ(file.check(all.codes, less(row), scratch, stored), status::capacity);
  EXPECT_EQ(file.check(all.codes, row, less(scratch), stored), status::capacity);
  EXPECT_EQ(file.check(all.codes, row, scratch, less(stored)), status::capacity);
  EXPECT_EQ(file.check(nullptr, row, scratch, stored), status::argument);
  EXPECT_EQ(file.statistics(all.codes, row, scratch, sums), status::ok);
  EXPECT_EQ(file.statistics(all.codes, less(row), scratch, sums), status::capacity);
  EXPECT_EQ(file.statistics(all.codes, row, less(scratch), sums), status::capacity);
  EXPECT_EQ(file.decode_row(0, all.codes, row, scratch, count), status::ok);
  EXPECT_EQ(file.decode_row(0, all.codes, row, less(scratch), count), status::capacity);
}

TEST(refusals, chunks_of_as_many_rows_as_there_cannot_be) {
  const std::vector<std::byte> zeros(100);
  row_chunk chunk;
  EXPECT_TRUE(chunk.open(zeros, 1));
  EXPECT_TRUE(chunk.open(zeros, layout::cells_per_block));
  EXPECT_FALSE(chunk.open(zeros, 0));
  EXPECT_FALSE(chunk.open(zeros, layout::cells_per_block + 1));
}

TEST(refusals, lists_that_are_not_closed) {
  const std::array<std::uint32_t, 2> reference{1, 5};
  const std::array<std::uint32_t, 5> closed{0, 1, no_border, no_border, no_border};
  const std::array<std::uint32_t, 5> open{0, 1, 2, no_border, no_border};
  std::array<std::uint32_t, 32> out{};
  std::size_t count = 0;
  EXPECT_TRUE(apply_rank_difference(reference, closed, closed, 10, out, count));
  EXPECT_FALSE(apply_rank_difference(reference, open, closed, 10, out, count));
  EXPECT_FALSE(apply_rank_difference(reference, closed, open, 10, out, count));
}

}  // namespace
