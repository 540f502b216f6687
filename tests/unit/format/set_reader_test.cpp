#include "sightcell/format/set_reader.h"

#include <gtest/gtest.h>

#include "sample_contents.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

void expect_runs_and_ids(const sample_contents& contents) {
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  set_reader sets;
  ASSERT_EQ(sets.open(file), status::ok);
  EXPECT_EQ(sets.file().cell_count(), 90u);
  for (std::uint32_t cell = 0; cell < 90; ++cell) {
    std::vector<std::uint32_t> ids{7};  // replaced
    ASSERT_EQ(sets.source_ids(cell, ids), status::ok);
    EXPECT_EQ(ids, contents.sets[cell]);
    std::span<const run> runs;
    ASSERT_EQ(sets.runs(cell, runs), status::ok);
    std::vector<std::uint32_t> from_runs;
    std::uint32_t next = 0;
    for (const run& r : runs) {
      EXPECT_TRUE(r.first >= next && r.count > 0);
      next = r.first + r.count + 1;
      for (std::uint32_t i = 0; i < r.count; ++i) from_runs.push_back(sets.source_of_stored()[r.first + i]);
    }
    std::sort(from_runs.begin(), from_runs.end());
    EXPECT_EQ(from_runs, contents.sets[cell]);
  }
  EXPECT_EQ(sets.check(), status::ok);
  row_statistics sums;
  EXPECT_EQ(sets.statistics(sums), status::ok);
  EXPECT_EQ(sums.cells, 90u);
}

TEST(set_reader, gives_runs_in_stored_order_and_ids_of_the_source) {
  sample_contents contents = random_contents(31, {.polygons = 700, .cells = 90});
  put_in_order(contents, 5);
  expect_runs_and_ids(contents);
  put_in_groups(contents, 6);
  expect_runs_and_ids(contents);
}

TEST(set_reader, agrees_with_the_reader) {
  auto bytes = small_contents().encode();
  reader file;
  set_reader sets;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  ASSERT_EQ(sets.open(file), status::ok);
  std::vector<std::uint32_t> ids{7};
  EXPECT_EQ(sets.source_ids(67, ids), status::argument);
  EXPECT_TRUE(ids.empty());
  bytes[section_offset(bytes, layout::section_rows) + 20] ^= std::byte{1};
  EXPECT_EQ(sets.check(), status::checksum);
}

TEST(set_reader, can_be_moved) {
  const auto bytes = small_contents().encode();
  reader file;
  set_reader made;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  ASSERT_EQ(made.open(file), status::ok);
  set_reader sets = std::move(made);
  std::vector<std::uint32_t> ids;
  EXPECT_EQ(sets.source_ids(12, ids), status::ok);
  EXPECT_EQ(ids, small_contents().sets[12]);
}

}  // namespace
