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

TEST(cell_set, members_of_a_record_share_their_witnesses) {
  const cell_record record{.set = {1, 4, 5, 7}, .witnesses = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, .witness_of = {2, 0, 1, 2}};
  cell_set set(10);
  set.add(4, {9, 0, 0});
  set.add_members(record, {1, 1, 0, 1});
  EXPECT_EQ(set.sorted(), (std::vector<std::uint32_t>{1, 4, 7}));
  EXPECT_EQ(set.witness(7), glm::vec3(3, 0, 0));
  EXPECT_EQ(set.witness(4), glm::vec3(9, 0, 0)) << "it was a member";
  EXPECT_EQ(set.eyes(), (std::vector<glm::vec3>{{9, 0, 0}, {3, 0, 0}})) << "others saw nothing that joined";
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

TEST(cell_set, counts_polygons_by_the_hemicube_that_found_them) {
  cell_set set(10000);
  std::uint32_t next = 0;
  const auto hemicube = [&](std::uint32_t finds) {
    std::vector<seen_polygon> seen{{9999, 1, 0}};  // and one that each of them sees
    for (std::uint32_t i = 0; i < finds; ++i) seen.push_back({next++, 1, 0});
    set.add_view({static_cast<float>(next), 0, 0}, seen);
  };
  hemicube(9);  // 1
  hemicube(5);  // 2
  hemicube(3);  // 3
  set.add(9000, {0, 0, 1});
  cell_record saved{.samples = 3};
  set.save(saved);
  growth_counts expected{10, 5, 3};
  EXPECT_EQ(saved.growth, expected) << "a ray is no hemicube";
  cell_set later(10000);
  later.load(saved);
  const finding of_search(later, found_by::later_hemicubes);
  later.add_view({7, 0, 0}, {{500, 1, 0}, {501, 1, 0}});  // 4
  later.add_view({8, 0, 0}, {{502, 1, 0}});               // 5
  for (int i = 6; i <= 20000; ++i) later.add_view({9, 0, 0}, {{static_cast<std::uint32_t>(600 + i % 8000), 1, 0}});
  later.save(saved);
  expected[2] += 2, expected[3] = 1 + 3;  // 5 .. 8
  for (std::size_t step = 4; step < growth_steps; ++step) expected[step] = 1u << (step - 1);
  expected[13] = 8000 - 3 - (4096 - 8);  // from 4,097 on; each of the 8,000 polygons joins once
  expected[12] = 2048;
  EXPECT_EQ(saved.growth, expected) << "counts go on in the next stage";
  later.clear();
  later.save(saved);
  EXPECT_EQ(saved.growth, growth_counts{});
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
