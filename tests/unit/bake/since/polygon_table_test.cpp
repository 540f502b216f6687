#include "since/polygon_table.h"

#include <gtest/gtest.h>

namespace sightcell::bake {
namespace {

polygon_table named(std::vector<std::uint64_t> names) {
  polygon_table table;
  table.corners.resize(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) table.corners[i][0].x = static_cast<float>(names[i]);
  table.near.resize(names.size());
  table.names = std::move(names);
  return table;
}

constexpr std::uint32_t no_match = polygon_edit::gone;

TEST(polygon_table, an_edit_matches_names) {
  const auto edit = [](std::vector<std::uint64_t> before, std::vector<std::uint64_t> now) {
    return edit_between(named(std::move(before)), named(std::move(now)));
  };
  polygon_edit found = edit({5, 6, 7, 8}, {5, 9, 7, 8});
  EXPECT_EQ(found.new_of, (std::vector<std::uint32_t>{0, no_match, 2, 3}));
  EXPECT_EQ(found.added, std::vector<std::uint32_t>{1});
  ASSERT_EQ(found.removed_corners.size(), 1u);
  EXPECT_EQ(found.removed_corners[0][0].x, 6.0f);
  found = edit({5, 6, 7, 8}, {8, 7, 6, 5});
  EXPECT_EQ(found.new_of, (std::vector<std::uint32_t>{3, 2, 1, 0}));
  EXPECT_TRUE(found.added.empty());
  found = edit({5, 6, 6, 8}, {5, 6, 6, 6, 8});
  EXPECT_EQ(found.new_of, (std::vector<std::uint32_t>{0, 1, 2, 4}));
  EXPECT_EQ(found.added, std::vector<std::uint32_t>{3});
  found = edit({5, 0, 6}, {5, 0, 6});
  EXPECT_EQ(found.new_of, (std::vector<std::uint32_t>{0, no_match, 2})) << "absent polygons have no match";
  EXPECT_TRUE(found.removed_corners.empty());
  found = edit({}, {5});
  EXPECT_EQ(found.added, std::vector<std::uint32_t>{0});
  found = edit({5, 5}, {});
  EXPECT_EQ(found.new_of, (std::vector<std::uint32_t>{no_match, no_match}));
  EXPECT_EQ(found.removed_corners.size(), 2u);
}

}  // namespace
}  // namespace sightcell::bake
