// What neighbors see is tried from this cell's places: what is seen from a few of them joins, what is seen from none
// does not.
#include "search/neighbor_check.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <vector>

#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "trace/ray_scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

constexpr int eye_count = 16;
constexpr box cell{{-0.5f, -1.0f, -1.0f}, {0.5f, 1.0f, 1.0f}};

// Eyes in a row along z, a wall at x = 2 with a slit at z = 1, and behind it a row of tiles. Through the slit an eye
// sees one or two of them: each is seen from a few eyes and from no others.
struct slit_and_tiles {
  std::vector<std::uint32_t> tiles;  // their first polygons, of two each
  std::uint32_t hidden = 0;
  scene::scene s;
  scene::world_geometry geometry;
  ray_scene rays;

  static glm::vec3 eye(int i) { return {0.0f, 0.0f, -1.0f + 2.0f * static_cast<float>(i) / (eye_count - 1)}; }

  slit_and_tiles() : s(made(tiles, hidden)), geometry(scene::flatten(s)), rays(geometry, false) {}

  static scene::scene made(std::vector<std::uint32_t>& tiles, std::uint32_t& hidden) {
    test::tiny_scene tiny;
    const auto toward_cell = [&](float x, float low, float high) {
      return tiny.quad({x, -1, low}, {x, -1, high}, {x, 1, high}, {x, 1, low});
    };
    toward_cell(2.0f, -20.0f, 0.9f);
    toward_cell(2.0f, 1.1f, 20.0f);
    for (int i = 0; i < eye_count; ++i) {
      const float z = 3.0f - 2.0f * eye(i).z;  // in line with the slit's middle
      tiles.push_back(toward_cell(6.0f, z - 0.05f, z + 0.05f));
    }
    hidden = toward_cell(6.0f, -15.0f, -14.0f);
    return tiny.finished();
  }

  // A neighbor beyond the cell that says it has all of them.
  cell_record neighbor() const {
    cell_record one;
    for (const std::uint32_t first : tiles) one.set.insert(one.set.end(), {first, first + 1});
    one.set.insert(one.set.end(), {hidden, hidden + 1});
    std::sort(one.set.begin(), one.set.end());
    one.witnesses = {{0.0f, 0.0f, 1.9f}};
    one.witness_of.assign(one.set.size(), 0);
    return one;
  }

  // The cell knows its eyes, and the wall from each of them.
  std::vector<std::uint32_t> tested(int threads, std::uint64_t& spent, double least_solid_angle = 0.0) const {
    cell_set set(s.polygon_count);
    for (int i = 0; i < eye_count; ++i) set.add_view(eye(i), {{.id = 0, .pixels = static_cast<std::uint32_t>(1 + i)}});
    const cell_record beside = neighbor();
    tbb::task_arena arena(threads);
    const neighbor_check_settings how{.seed = 1, .place = 1, .rules = {}, .least_solid_angle = least_solid_angle};
    arena.execute([&] { spent = neighbor_check(rays, cell, how, {&beside, 1}, set); });
    return set.sorted();
  }
};

TEST(neighbor_check, finds_what_few_eyes_see_and_nothing_else) {
  const slit_and_tiles world;
  std::uint64_t spent = 0;
  const auto found = world.tested(1, spent);
  const auto has = [&](std::uint32_t polygon) { return std::binary_search(found.begin(), found.end(), polygon); };
  // A tile is two triangles, and its halves are as hard to see as each other.
  const auto count = std::count_if(world.tiles.begin(), world.tiles.end(), has);
  EXPECT_GE(count, eye_count - 1);
  EXPECT_FALSE(has(world.hidden) || has(world.hidden + 1)) << "its neighbor says so, but no ray";
  EXPECT_LE(spent, 2u * (eye_count + 1) * 40u);
}

TEST(neighbor_check, random_eyes_test_large_polygons_only) {
  const slit_and_tiles world;
  constexpr std::uint64_t polygons = 2 * (eye_count + 1), chosen = 6;
  std::uint64_t of_small = 0, of_large = 0;
  world.tested(1, of_small, 100.0);  // larger than all directions
  EXPECT_LE(of_small, polygons * chosen);
  world.tested(1, of_large, 1e-9);
  EXPECT_GE(of_large, 2 * (chosen + 28)) << "the hidden polygons are tried as often as it goes";
  EXPECT_GT(of_large, of_small);
}

TEST(neighbor_check, of_a_neighbor_in_the_block_only_what_is_late_is_tried) {
  cell_record neighbor;
  neighbor.set = {2, 3, 5, 8, 13};
  neighbor.witnesses = {{1, 0, 0}, {2, 0, 0}};
  neighbor.witness_of = {0, 1, 1, 0, 1};
  neighbor.late = {3, 8, 13};
  keep_late(neighbor);
  EXPECT_EQ(neighbor.set, (std::vector<std::uint32_t>{3, 8, 13}));
  EXPECT_EQ(neighbor.witness_of, (std::vector<std::uint32_t>{1, 0, 1}));
  const std::vector<std::uint32_t> own{1, 8};
  drop_known(own, neighbor);
  EXPECT_EQ(neighbor.set, (std::vector<std::uint32_t>{3, 13}));
  EXPECT_EQ(neighbor.witness_of, (std::vector<std::uint32_t>{1, 1}));
  neighbor.late.clear();
  keep_late(neighbor);
  EXPECT_TRUE(neighbor.set.empty());
}

TEST(neighbor_check, does_not_depend_on_threads) {
  const slit_and_tiles world;
  std::uint64_t spent_by_one = 0, spent_by_four = 0;
  EXPECT_EQ(world.tested(1, spent_by_one), world.tested(4, spent_by_four));
  EXPECT_EQ(spent_by_one, spent_by_four);
}

}  // namespace
}  // namespace sightcell::bake
