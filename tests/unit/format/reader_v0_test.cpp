// Files of version 0, which no writer makes any more: the golden ones are read with the contents that they were written
// from.
#include <gtest/gtest.h>

#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/set_reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

TEST(reader_v0, golden_files_are_what_they_were_written_from) {
  for (const auto& [name, contents] :
       {std::pair("v0_tiny", tiny_contents()), std::pair("v0_small", small_contents())}) {
    const auto bytes = golden_file(name);
    reader file;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    EXPECT_EQ(file.format_version(), 0u);
    EXPECT_EQ(check_all(file), status::ok);
    ASSERT_EQ(file.cell_count(), contents.sets.size());
    EXPECT_EQ(file.settings(), contents.settings);
    EXPECT_EQ(file.codes_size(), 0u);
    EXPECT_EQ(file.order_count(), file.draw_count());
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      status s = status::ok;
      box b;
      EXPECT_EQ(decode_set(file, cell, s), contents.sets[cell]) << cell;
      ASSERT_EQ(file.cell_box(cell, b), status::ok);
      EXPECT_EQ(b.max, contents.cells[cell].max);
    }
    for (std::uint32_t d = 0; d < file.draw_count(); ++d) {
      draw_record r;
      ASSERT_EQ(file.draw(d, r), status::ok);
      const draw_record& w = contents.draws[d];
      EXPECT_TRUE(r.node == w.node && r.mesh == w.mesh && r.primitive == w.primitive && r.instance == w.instance &&
                  r.material == w.material && r.first_source == w.first_source && r.polygon_count == w.polygon_count &&
                  r.first_stored == w.first_stored && r.base_vertex == w.base_vertex && r.host_tag == w.host_tag);
    }
  }
}

TEST(reader_v0, rows_are_those_of_the_directory) {
  const auto bytes = golden_file("v0_small");
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  set_reader sets;
  row_statistics sums;
  ASSERT_EQ(sets.open(file), status::ok);
  ASSERT_EQ(sets.statistics(sums), status::ok);
  std::uint64_t bytes_of_rows = 0;
  std::uint64_t deltas = 0;
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    row_record r;
    ASSERT_EQ(file.row(cell, r), status::ok);
    EXPECT_EQ(r.shared, cell == 20);
    if (!r.shared) bytes_of_rows += r.size;
    deltas += r.delta ? 1 : 0;
  }
  EXPECT_EQ(sums.row_bytes, bytes_of_rows);
  EXPECT_EQ(sums.delta_rows, deltas);
  EXPECT_GT(deltas, 30u);
  EXPECT_EQ(sums.directory_bytes, 2 * layout::chunk_record_size + 67 * layout::v0_row_record_size);
}

TEST(reader_v0, a_damaged_chunk_leaves_the_other_alone) {
  auto bytes = golden_file("v0_small");
  bytes[section_offset(bytes, layout::section_rows) + 5] ^= std::byte{1};
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.check_chunk(0), status::checksum);
  EXPECT_EQ(file.check_chunk(1), status::ok);
}

// The fields at the end of version 1's header do not exist in version 0.
TEST(reader_v0, what_was_reserved_is_zero) {
  for (const std::size_t at : {layout::header_list_bound, layout::header_slack}) {
    auto bytes = golden_file("v0_tiny");
    set_u32(bytes, at, 1);
    reseal(bytes);
    reader file;
    EXPECT_EQ(reader::open(bytes, file), status::corrupt) << at;
  }
}

// Three differences in a row, and two that refer to each other.
TEST(reader_v0, references_too_deep_or_closed) {
  const auto whole = golden_file("v0_small");
  const std::size_t rows = section_offset(whole, layout::section_rows);
  const std::size_t directory = section_offset(whole, layout::section_row_directory) + 2 * layout::chunk_record_size;
  // A row of version 0 as a difference that changes nothing: {no runs removed, reference, no runs added, no bytes of
  // the removed}.
  const auto refer = [&](std::vector<std::byte>& bytes, std::uint32_t cell, std::uint32_t reference) {
    const std::size_t record = directory + layout::v0_row_record_size * cell;
    ASSERT_GE(get_u32(bytes, record + 4), 4u);
    set_u32(bytes, record + 4, 4);
    set_u32(bytes, rows + get_u32(bytes, record), 1 | reference << 8);
  };
  const auto outcome = [](std::vector<std::byte>& bytes, std::uint32_t cell) {
    reseal(bytes);
    reader file;
    EXPECT_EQ(reader::open(bytes, file), status::ok);
    status s = status::ok;
    decode_set(file, cell, s);
    return s;
  };
  // A cell with an own row.
  reader file;
  ASSERT_EQ(reader::open(whole, file), status::ok);
  std::uint32_t own = 0;
  for (row_record r; file.row(own, r) == status::ok && (r.delta || r.size < 4 || r.shared);) ++own;
  ASSERT_LT(own, 50u);
  const std::uint32_t a = own + 1;
  auto chain = whole;
  refer(chain, a, own);
  refer(chain, a + 1, a);
  refer(chain, a + 2, a + 1);
  EXPECT_EQ(outcome(chain, a), status::ok);
  EXPECT_EQ(outcome(chain, a + 1), status::ok);
  EXPECT_EQ(outcome(chain, a + 2), status::corrupt);
  auto loop = whole;
  refer(loop, a, a + 1);
  refer(loop, a + 1, a);
  EXPECT_EQ(outcome(loop, a), status::corrupt);
  auto itself = whole;
  refer(itself, a, a);
  EXPECT_EQ(outcome(itself, a), status::corrupt);
}

}  // namespace
