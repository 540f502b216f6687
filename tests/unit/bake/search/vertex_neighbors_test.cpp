#include "search/vertex_neighbors.h"

#include <gtest/gtest.h>

#include <set>

#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::scene_with_rays;
using test::tiny_scene;

TEST(vertex_neighbors, joins_what_shares_a_place) {
  tiny_scene tiny;
  const auto first = tiny.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const auto second = tiny.triangle({1, 0, 0}, {2, 0, 0}, {1, 1, 0});  // another draw, same place
  const auto apart = tiny.triangle({5, 0, 0}, {6, 0, 0}, {5, 1, 0});
  const auto zero = tiny.triangle({-0.0f, 0, 0}, {0, -1, 0}, {-1, 0, 0});
  const scene_with_rays w(tiny);
  std::set<std::uint32_t> near;
  w.neighbors.sharing.for_each(first, [&](std::uint32_t n) { near.insert(n); });
  EXPECT_EQ(near, (std::set<std::uint32_t>{first, second, zero}));
  near.clear();
  w.neighbors.sharing.for_each(apart, [&](std::uint32_t n) { near.insert(n); });
  EXPECT_EQ(near, std::set<std::uint32_t>{apart});
}

}  // namespace
}  // namespace sightcell::bake
