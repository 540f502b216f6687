// Files with sets that are known to be wrong, and what hosts with levels of detail draw of them.
#include "sightcell/bake/verify_cut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "errors/error_id.h"
#include "file/pvs_output.h"
#include "sightcell/scene/cluster_dag.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

scene::geometry ball(float x, std::uint32_t around, std::uint32_t rows) {
  scene::geometry mesh;
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double u = 2.0 * std::numbers::pi * i / around, v = std::numbers::pi * j / rows;
      mesh.positions.emplace_back(x + std::sin(v) * std::cos(u), std::cos(v), std::sin(v) * std::sin(u));
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = j * around + i, b = j * around + (i + 1) % around, c = a + around, d = b + around;
      for (const std::uint32_t corner : {a, b, c, b, d, c}) mesh.indices.push_back(corner);
    }
  return mesh;
}

// A cell in a room, and a ball of 3,840 triangles 10 m from it; a second one behind it that moves.
class verified_cuts : public testing::Test {
 protected:
  verified_cuts() {
    test::tiny_scene tiny;
    tiny.closed_box({-4, -4, -4}, {20, 4, 4}, true);
    scene_ = tiny.finished();
    for (const float x : {10.0f, 15.0f}) {
      scene::draw d;
      d.node = d.mesh = d.geometry = static_cast<std::uint32_t>(scene_.geometries.size());
      d.moves = x > 12.0f;
      scene_.geometries.push_back(ball(x, 60, 32));
      scene_.draws.push_back(d);
    }
    scene::finish(scene_);
    std::vector<std::uint32_t> all(scene_.polygon_count);
    std::iota(all.begin(), all.end(), 0u);
    write(all);
  }

  // Adds a wall that closes the room around the first ball, but for a round hole of this radius, and a sheet far behind
  // it, each as a draw of its own. Returns the set of what is visible from the cell at level 0: no sheet, no second
  // ball.
  std::vector<std::uint32_t> close_room_around_ball(double hole) {
    scene::geometry wall;
    constexpr std::uint32_t around = 64;
    for (std::uint32_t i = 0; i < around; ++i) {
      const double u = 2.0 * std::numbers::pi * i / around;
      for (const double radius : {hole, 6.0})
        wall.positions.emplace_back(10.0, radius * std::sin(u), radius * std::cos(u));
    }
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = 2 * i, b = a + 1, c = 2 * ((i + 1) % around), d = c + 1;
      for (const std::uint32_t corner : {a, b, c, b, d, c}) wall.indices.push_back(corner);
    }
    scene::geometry sheet;
    sheet.positions = {{18, -3, -3}, {18, 3, -3}, {18, 3, 3}, {18, -3, 3}};
    sheet.indices = {0, 1, 2, 0, 2, 3};
    add_double_sided(std::move(wall), false);
    add_double_sided(std::move(sheet), false);
    scene::finish(scene_);
    std::vector<std::uint32_t> set;
    for (std::uint32_t polygon = 0; polygon < scene_.draws[4].first_source; ++polygon)
      if (polygon < end_of_ball() || polygon >= scene_.draws[3].first_source) set.push_back(polygon);
    return set;
  }

  void add_double_sided(scene::geometry mesh, bool with_levels) {
    scene::draw d;
    d.node = d.mesh = d.geometry = static_cast<std::uint32_t>(scene_.geometries.size());
    d.material = static_cast<std::uint32_t>(scene_.materials.size());
    d.moves = !with_levels;
    scene_.materials.push_back(scene_.materials.front());
    scene_.materials.back().double_sided = true;
    scene_.geometries.push_back(std::move(mesh));
    scene_.draws.push_back(d);
  }

  void write(std::vector<std::uint32_t> set, float smallest_gap = 0.0f) {
    settings how;
    how.smallest_gap = smallest_gap;
    how.margin = 0.0f;
    std::vector<cell_record> records(1);
    records[0].set = std::move(set);
    summary sum;
    write_pvs(
        frame_of(scene_, how, describe(how), {view_cell{{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, "", 1}}),
        [&](std::uint32_t cell) { return records[cell]; }, path(), {}, sum);
  }

  std::vector<cut_verification> check(const cut_settings& cut, std::uint32_t threads = 0,
                                      std::uint64_t rays = 20'000) const {
    return verify_cut(scene_, test::file_bytes(path()), "cut.pvs", {.rays = rays, .threads = threads}, cut, {});
  }

  std::filesystem::path path() const { return folder_.path() / "cut.pvs"; }
  std::uint32_t first_of_ball() const { return scene_.draws[1].first_source; }
  std::uint32_t end_of_ball() const { return scene_.draws[2].first_source; }

  test::fresh_folder folder_;
  scene::scene scene_;
};

TEST_F(verified_cuts, of_a_set_with_all_have_no_misses_and_fewer_triangles) {
  const std::vector<cut_verification> cuts = check({.pixels = {0.0, 1.0, 8.0}});
  ASSERT_EQ(cuts.size(), 3u);
  for (const cut_verification& cut : cuts) {
    EXPECT_EQ(cut.rays, 20'000u);
    EXPECT_EQ(cut.misses, 0u);
    EXPECT_GT(cut.upper_bound, 0.0);
    EXPECT_EQ(cut.cut_triangles, cut.drawn_triangles);
    EXPECT_EQ(cut.set_polygons, scene_.polygon_count);
  }
  EXPECT_EQ(cuts[0].cut_triangles, scene_.polygon_count);
  EXPECT_EQ(cuts[0].cut_clusters, cuts[0].leaf_clusters);
  EXPECT_LT(cuts[1].cut_triangles, 0.9 * cuts[0].cut_triangles);
  EXPECT_LT(cuts[2].cut_triangles, cuts[1].cut_triangles);
  EXPECT_GT(cuts[2].cut_triangles, 3840.0) << "what moves has no levels";
  EXPECT_GT(cuts[2].coarse_clusters, 10u);
}

TEST_F(verified_cuts, show_clusters_that_the_set_lacks) {
  const scene::cluster_dag dag = scene::build_cluster_dag(scene_.geometries[scene_.draws[1].geometry]);
  const scene::geometry& mesh = scene_.geometries[scene_.draws[1].geometry];
  std::uint32_t nearest = 0;  // triangle
  for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t)
    if (mesh.positions[mesh.indices[3 * t]].x < mesh.positions[mesh.indices[3 * nearest]].x) nearest = t;
  const std::uint32_t leaf = dag.of_triangle[nearest];
  std::vector<std::uint32_t> without_leaf, without_ball;
  for (std::uint32_t polygon = 0; polygon < scene_.polygon_count; ++polygon) {
    const bool of_ball = polygon >= first_of_ball() && polygon < end_of_ball();
    if (!of_ball) without_ball.push_back(polygon);
    if (!of_ball || dag.of_triangle[polygon - first_of_ball()] != leaf) without_leaf.push_back(polygon);
  }
  write(without_leaf);
  std::vector<cut_verification> cuts = check({.pixels = {0.0, 8.0}});
  const verification plain = verify(scene_, test::file_bytes(path()), "cut.pvs", {.rays = 20'000}, verify_progress{});
  EXPECT_GT(plain.misses, 0u);
  EXPECT_EQ(cuts[0].misses, plain.misses) << "the rays are the same";
  EXPECT_EQ(cuts[0].misses_of_leaves, plain.misses);
  ASSERT_EQ(cuts[0].missing.size(), 1u);
  EXPECT_EQ(cuts[0].missing[0].draw, 1u);
  EXPECT_EQ(cuts[0].missing[0].cluster, leaf);
  EXPECT_TRUE(cuts[0].missing[0].leaf);
  EXPECT_EQ(cuts[0].missing[0].rays, plain.misses);
  EXPECT_EQ(cuts[0].misses_of_set, plain.misses);
  EXPECT_EQ(cuts[1].misses, 0u) << "a coarse cluster is visible by any leaf below it";

  write(without_ball);
  cuts = check({.pixels = {8.0}});
  EXPECT_GT(cuts[0].misses, 10u);
  EXPECT_EQ(cuts[0].misses_of_set, cuts[0].misses);
  EXPECT_GT(cuts[0].upper_bound, cuts[0].pixel_error);
  ASSERT_FALSE(cuts[0].missing.empty());
  EXPECT_FALSE(cuts[0].missing[0].leaf);
  EXPECT_GE(cuts[0].missing[0].cluster, dag.leaf_count);
  EXPECT_NEAR(cuts[0].missing[0].target[0], 9.5f, 0.8f) << "on the ball";
  EXPECT_EQ(cuts[0].drawn_triangles, 3852.0);
}

// A ball closes a round hole in a wall. Its coarse clusters are smaller, so the cut has a slit around it.
TEST_F(verified_cuts, count_what_shows_through_a_slit_in_the_cut) {
  write(close_room_around_ball(0.98), 0.1f);
  const std::vector<cut_verification> cuts = check({.pixels = {0.0, 64.0}}, 0, 100'000);
  EXPECT_EQ(cuts[0].misses, 0u) << "the set has all that is visible without levels";
  EXPECT_EQ(cuts[0].rays_opened, 0u);
  const cut_verification& coarse = cuts[1];
  EXPECT_GT(coarse.misses, 10u) << "however solid level 0 is there";
  EXPECT_EQ(coarse.misses_revealed, coarse.misses);
  EXPECT_EQ(coarse.misses_of_leaves, coarse.misses);
  EXPECT_EQ(coarse.rays_in_gaps, 0u);
  ASSERT_FALSE(coarse.missing.empty());
  EXPECT_EQ(coarse.missing[0].draw, 4u);
  EXPECT_EQ(coarse.missing[0].kind, cut_miss::revealed);
  EXPECT_NEAR(coarse.missing[0].target[0], 18.0f, 1e-3f) << "the sheet";
}

TEST_F(verified_cuts, count_openings_apart_from_misses) {
  (void)close_room_around_ball(0.98);
  std::vector<std::uint32_t> all(scene_.polygon_count);
  std::iota(all.begin(), all.end(), 0u);
  write(all);
  const cut_verification coarse = check({.pixels = {64.0}}, 0, 100'000)[0];
  EXPECT_EQ(coarse.misses, 0u);
  EXPECT_GT(coarse.rays_opened, 10u);
  EXPECT_EQ(coarse.rays_opened_beyond_error, 0u);
}

// Two shells around the cell, of which the outer one has levels: its coarse clusters come through the inner one.
TEST_F(verified_cuts, count_coarse_clusters_of_which_the_set_has_no_leaf) {
  for (const float radius : {3.0f, 3.0005f}) {
    scene::geometry shell = ball(0.0f, 120, 64);
    for (glm::vec3& position : shell.positions) position *= radius;
    add_double_sided(std::move(shell), radius > 3.0f);
  }
  scene::finish(scene_);
  std::vector<std::uint32_t> inner(scene_.draws[3].polygon_count);
  std::iota(inner.begin(), inner.end(), scene_.draws[3].first_source);
  write(inner);
  const std::vector<cut_verification> cuts = check({.pixels = {0.0, 256.0}});
  EXPECT_EQ(cuts[0].misses, 0u);
  EXPECT_GT(cuts[1].misses, 100u);
  EXPECT_EQ(cuts[1].misses_at_coarse, cuts[1].misses);
  EXPECT_EQ(cuts[1].misses_of_leaves, 0u);
  ASSERT_FALSE(cuts[1].missing.empty());
  EXPECT_EQ(cuts[1].missing[0].draw, 4u);
  EXPECT_EQ(cuts[1].missing[0].kind, cut_miss::at_coarse);
}

TEST_F(verified_cuts, excuse_gaps_of_level_0_alone) {
  const std::vector<std::uint32_t> set = close_room_around_ball(1.05);
  const cut_settings cut{.pixels = {8.0}};
  write(set);
  for (const cut_verification& open : check(cut, 0, 100'000)) {
    EXPECT_GT(open.misses, 10u);
    EXPECT_GE(open.misses, open.misses_of_set);
    EXPECT_EQ(open.rays_in_gaps, 0u);
  }
  write(set, 0.1f);
  for (const cut_verification& narrow : check(cut, 0, 100'000)) {
    EXPECT_EQ(narrow.misses, narrow.misses_revealed);
    EXPECT_GT(narrow.rays_in_gaps, 10u);
  }
}

TEST_F(verified_cuts, are_the_same_with_any_number_of_threads) {
  const cut_settings cut{.pixels = {2.0}};
  const cut_verification one = check(cut, 1)[0], two = check(cut, 2)[0];
  EXPECT_EQ(one.misses, two.misses);
  EXPECT_EQ(one.cut_clusters, two.cut_clusters);
  EXPECT_EQ(one.drawn_triangles, two.drawn_triangles);
}

TEST_F(verified_cuts, refuse_what_is_no_picture) {
  for (const cut_settings& cut :
       {cut_settings{.pixels = {-1.0}}, cut_settings{.rows = 0}, cut_settings{.fov = 180.0}, cut_settings{.fov = 0.0}})
    EXPECT_EQ(test::error_id([&] { (void)check(cut); }), "settings.out-of-range");
}

}  // namespace
}  // namespace sightcell::bake
