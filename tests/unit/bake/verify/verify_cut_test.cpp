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

  void write(std::vector<std::uint32_t> set) {
    settings how;
    how.margin = 0.0f;
    std::vector<cell_record> records(1);
    records[0].set = std::move(set);
    summary sum;
    write_pvs(
        frame_of(scene_, how, describe(how), {view_cell{{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, "", 1}}),
        [&](std::uint32_t cell) { return records[cell]; }, path(), {}, sum);
  }

  std::vector<cut_verification> check(const cut_settings& cut, std::uint32_t threads = 0) const {
    return verify_cut(scene_, test::file_bytes(path()), "cut.pvs", {.rays = 20'000, .threads = threads}, cut, {});
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
  EXPECT_EQ(cuts[1].misses, 0u) << "a coarse cluster is visible by any leaf below it";

  write(without_ball);
  cuts = check({.pixels = {8.0}});
  EXPECT_GT(cuts[0].misses, 10u);
  EXPECT_GT(cuts[0].upper_bound, cuts[0].pixel_error);
  ASSERT_FALSE(cuts[0].missing.empty());
  EXPECT_FALSE(cuts[0].missing[0].leaf);
  EXPECT_GE(cuts[0].missing[0].cluster, dag.leaf_count);
  EXPECT_NEAR(cuts[0].missing[0].target[0], 9.5f, 0.8f) << "on the ball";
  EXPECT_EQ(cuts[0].drawn_triangles, 3852.0);
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
