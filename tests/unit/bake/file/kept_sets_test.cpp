#include "file/kept_sets.h"

#include <gtest/gtest.h>

#include <vector>

namespace sightcell::bake {
namespace {

TEST(kept_sets, a_set_that_has_no_room_is_read_again) {
  const std::vector<std::vector<std::uint32_t>> sets{{}, {0, 1, 2, 7, 4000000000u}, {5, 6, 7, 9}};
  std::vector<std::uint32_t> read;
  const std::function<cell_record(std::uint32_t)> record_of = [&](std::uint32_t cell) {
    read.push_back(cell);
    cell_record record;
    record.set = sets[cell];
    return record;
  };
  // Bytes: one for no ids; count, two runs of two and one of 5 + 1; count and two runs of two.
  kept_sets kept(record_of, 1 + 5);
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) kept.keep(cell, kept_sets::bytes_of(sets[cell]));
  for (int round = 0; round < 2; ++round)
    for (std::uint32_t cell = 0; cell < sets.size(); ++cell) EXPECT_EQ(kept.of(cell), sets[cell]) << cell;
  EXPECT_EQ(read, (std::vector<std::uint32_t>{1, 1})) << "the second set takes 11 bytes";
  EXPECT_EQ(kept.mean_bytes(), 3u);
}

}  // namespace
}  // namespace sightcell::bake
