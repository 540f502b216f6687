// Connected polygons that are visible from about the same cells.
#include "stream/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace sightcell::bake {
namespace {

// A strip of `count` polygons; those before `border` are visible from cells 0 .. 29, others from 30 .. 59.
struct polygon_strip {
  std::vector<std::uint32_t> polygons, corners;
  sketch_table seen;

  polygon_strip(std::uint32_t count, std::uint32_t border) : polygons(count), seen(count) {
    std::iota(polygons.begin(), polygons.end(), 0u);
    for (std::uint32_t i = 0; i < count; ++i) corners.insert(corners.end(), {i, i + 1, i + 2});
    for (std::uint32_t cell = 0; cell < 60; ++cell) {
      seen.begin_cell(cell);
      for (std::uint32_t i = 0; i < count; ++i)
        if ((i < border) == (cell < 30)) seen.add(i, 5);
    }
  }
  std::vector<std::vector<std::uint32_t>> patches() const {
    return patches_of(polygons, corners, [this](std::uint32_t polygon) -> const sketch& { return seen[polygon]; });
  }
};

TEST(patches, join_neighbors_that_are_seen_alike) {
  const auto patches = polygon_strip(20, 20).patches();
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_EQ(patches[0].size(), 20u);
}

TEST(patches, end_where_other_cells_see_the_surface) {
  const auto patches = polygon_strip(20, 7).patches();
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_EQ(patches[0].size(), 7u);
  EXPECT_EQ(patches[1].front(), 7u);
}

TEST(patches, have_limited_sizes_and_each_polygon_once) {
  std::vector<std::uint32_t> all;
  for (const auto& patch : polygon_strip(1'000, 400).patches()) {
    EXPECT_LE(patch.size(), 64u);
    all.insert(all.end(), patch.begin(), patch.end());
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, polygon_strip(1'000, 400).polygons);
}

TEST(patches, leave_polygons_alone_that_share_a_vertex_only) {
  polygon_strip apart(4, 4);
  apart.corners = {0, 1, 2, 2, 3, 4, 4, 5, 6, 6, 7, 8};
  EXPECT_EQ(apart.patches().size(), 4u);
}

}  // namespace
}  // namespace sightcell::bake
