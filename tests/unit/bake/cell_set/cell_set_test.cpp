#include "cell_set/cell_set.h"

#include <gtest/gtest.h>

#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

TEST(cell_set, keeps_the_witness_that_saw_most) {
  cell_set set(10);
  set.add_view({1, 0, 0}, {{2, 5}, {7, 1}});
  set.add_view({2, 0, 0}, {{2, 3}, {7, 9}});
  EXPECT_EQ(set.size(), 2u);
  EXPECT_EQ(set.witness(2), glm::vec3(1, 0, 0));
  EXPECT_EQ(set.witness(7), glm::vec3(2, 0, 0));
}

TEST(cell_set, a_ray_adds_once) {
  cell_set set(10);
  EXPECT_TRUE(set.add(4, {0, 0, 1}));
  EXPECT_FALSE(set.add(4, {0, 0, 2}));
  EXPECT_EQ(set.witness(4), glm::vec3(0, 0, 1));
  EXPECT_EQ(set.sorted(), std::vector<std::uint32_t>{4});
}

TEST(cell_set, clear_forgets_everything) {
  cell_set set(10);
  set.add(4, {0, 0, 1});
  set.clear();
  EXPECT_FALSE(set.contains(4));
  EXPECT_EQ(set.size(), 0u);
  set.add(3, {1, 0, 0});
  set.add(1, {2, 0, 0});
  EXPECT_EQ(set.members(), (std::vector<std::uint32_t>{3, 1}));
  EXPECT_EQ(set.sorted(), (std::vector<std::uint32_t>{1, 3}));
}

TEST(cell_set, counts_polygons_by_what_found_them) {
  cell_set set(10);
  set.add_view({1, 0, 0}, {{2, 5}, {7, 1}});
  {
    const finding rays(set, found_by::nearby_rays);
    set.add(7, {2, 0, 0});  // is a member
    set.add(3, {2, 0, 0});
    {
      const finding misses(set, found_by::verification);
      set.add(5, {3, 0, 0});
    }
    set.add(4, {2, 0, 0});
  }
  set.add(6, {2, 0, 0});
  cell_record saved;
  set.save(saved);
  EXPECT_EQ(saved.found, (find_counts{3, 0, 0, 0, 2, 1, 0}));
  cell_set later(10);
  later.load(saved);
  const finding touching(later, found_by::touching);
  later.add(9, {4, 0, 0});
  later.save(saved);
  EXPECT_EQ(saved.found, (find_counts{3, 1, 0, 0, 2, 1, 0})) << "counts go on in the next stage";
  later.clear();
  later.save(saved);
  EXPECT_EQ(saved.found, find_counts{});
}

TEST(cell_set, who_joins_brings_its_duplicates) {
  test::tiny_scene tiny;
  const auto wall = tiny.wall_x(2, -1, 1), apart = tiny.wall_x(3, -1, 1), again = tiny.wall_x(2, -1, 1);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const duplicate_classes classes(geometry, false);
  cell_set set(s.polygon_count, &classes);
  EXPECT_TRUE(set.add(wall, {0, 0, 0}));
  EXPECT_FALSE(set.add(again, {0, 0, 1}));
  EXPECT_EQ(set.sorted(), (std::vector<std::uint32_t>{wall, again}));
  EXPECT_EQ(set.witness(again), glm::vec3(0, 0, 0));
  cell_record saved;
  set.save(saved);
  EXPECT_EQ(saved.found, (find_counts{2, 0, 0, 0, 0, 0, 0})) << "both are counted";
  set.add_view({1, 0, 0}, {{again + 1, 9}, {apart, 3}});
  EXPECT_EQ(set.sorted(), (std::vector<std::uint32_t>{wall, wall + 1, apart, again, again + 1}));
  EXPECT_EQ(set.witness(wall + 1), glm::vec3(1, 0, 0));
}

}  // namespace
}  // namespace sightcell::bake
