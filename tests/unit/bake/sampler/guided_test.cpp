// gvs and its kin: their sets depend on nothing but settings and places.
#include <gtest/gtest.h>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "sampler/cell_sampler.h"
#include "sampler/gvs_plus_plus.h"
#include "search/aim.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"
#include "unit/bake/sampler/geometry_checks.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::ray_meets;

// A street: boxes left and right of the cell and slabs before what is behind them, so that there is much to find.
scene::scene street(bool reversed) {
  test::tiny_scene made;
  std::vector<std::array<glm::vec3, 2>> boxes;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) {
      const float x = 3.0f + 3.0f * static_cast<float>(row), z = -9.0f + 3.1f * static_cast<float>(column);
      boxes.push_back({glm::vec3{x, 0, z}, glm::vec3{x + 1.3f, 1.0f + 0.4f * static_cast<float>(row), z + 1.7f}});
    }
  if (reversed) std::reverse(boxes.begin(), boxes.end());
  for (const auto& [low, high] : boxes) made.closed_box(low, high);
  made.quad({-40, 0, -40}, {-40, 0, 40}, {40, 0, 40}, {40, 0, -40});
  return made.finished();
}

struct sampler_outcome {
  std::vector<std::uint64_t> names;  // of the members' places, ascending
  std::vector<std::uint32_t> members;
  std::uint64_t rays = 0;
};

class no_hemicubes final : public hemicube_source {
 public:
  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view>) override { EXPECT_TRUE(poses.empty()); }
  void render_image(const pose&, hemicube_image&) override {}
  std::uint32_t resolution() const override { return 64; }
  std::string device() const override { return "none"; }
};

sampler_outcome sample(const settings& how, const scene::scene& from, int threads, bool geometry_inside = false) {
  const scene::world_geometry geometry = scene::flatten(from, scene::animated_as::always);
  const ray_scene rays(geometry, false);
  no_hemicubes source;
  const box grown{{-2, 0.2f, -2}, {2, 2, 2}};
  const std::array<view_cell, 1> cells{{{grown.min + how.margin, grown.max - how.margin, "", 5}}};
  const auto sampler = make_cell_sampler(how, {rays, source, nullptr, cells});
  cell_set set(static_cast<std::uint32_t>(geometry.kinds.size()));
  const std::vector<glm::vec3> free{{0, 1, 0}};
  sampler_outcome result;
  tbb::task_arena arena(threads);
  arena.execute([&] {
    sampler->prepare([](double) { return true; });
    const time_limit limit(how.seconds_per_cell, true);
    result.rays = sampler->sample({grown, 5, geometry_inside, free, nullptr, &limit}, set).rays;
  });
  result.members = set.members();
  for (const std::uint32_t polygon : result.members) result.names.push_back(name_of(corners_of(geometry, polygon)));
  std::sort(result.names.begin(), result.names.end());
  return result;
}

class ray_samplers : public testing::TestWithParam<const char*> {
 protected:
  ray_samplers() {
    how.sampler = GetParam();
    how.sampling_rays = 40'000;
    how.rays_per_round = 2'048;
  }
  settings how;
};

TEST_P(ray_samplers, threads_change_nothing) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 8);
  const scene::scene city = street(false);
  for (const bool geometry_inside : {false, true}) {
    const sampler_outcome one = sample(how, city, 1, geometry_inside);
    EXPECT_GT(one.members.size(), 60u);
    for (const int threads : {2, 8}) {
      const sampler_outcome more = sample(how, city, threads, geometry_inside);
      EXPECT_EQ(more.members, one.members) << threads << " threads";
      EXPECT_EQ(more.rays, one.rays);
    }
  }
}

TEST_P(ray_samplers, the_order_of_polygons_changes_nothing) {
  how.sampling_rays = 5'000;  // not enough to follow all: who comes first matters
  const sampler_outcome one = sample(how, street(false), 2), other = sample(how, street(true), 2);
  EXPECT_EQ(one.names, other.names);
  EXPECT_EQ(one.rays, other.rays);
}

TEST_P(ray_samplers, all_rays_are_spent_and_no_more) {
  const scene::scene city = street(false);
  for (const std::uint64_t rays : {1'000u, 1'337u, 30'000u}) {
    how.sampling_rays = rays;
    EXPECT_EQ(sample(how, city, 2).rays, rays);
  }
}

TEST_P(ray_samplers, end_when_a_round_finds_little) {
  how.sampling_rays = 4'000'000;
  how.fewest_new = 2;
  EXPECT_LT(sample(how, street(false), 2).rays, 1'000'000u);
}

TEST_P(ray_samplers, a_limit_of_time_ends_a_cell) {
  how.sampling_rays = 100'000'000'000;
  how.seconds_per_cell = 1e-9;
  EXPECT_LE(sample(how, street(false), 2).rays, 200'000u);
}

TEST_P(ray_samplers, nothing_is_seen_from_places_that_are_not_free) {
  // The cell's lower half lies in a closed box, under whose ground something stands that only eyes in it could see.
  test::tiny_scene made;
  made.closed_box({-30, -30, -30}, {30, 1, 30});
  const std::uint32_t hidden = made.closed_box({8, -2, -2}, {10, 0.5f, 2});
  const sampler_outcome seen = sample(how, made.finished(), 2, true);
  EXPECT_FALSE(seen.members.empty());
  for (const std::uint32_t polygon : seen.members) EXPECT_LT(polygon, hidden);
}

INSTANTIATE_TEST_SUITE_P(guided, ray_samplers, testing::Values("gvs", "gvs++", "agvs"));

TEST(gvs_plus_plus, border_points_go_around_the_triangle) {
  const triangle t{{{3, 0, 0}, {4, 2, 0}, {5, 0, 1}}};
  const glm::vec3 eye{0, 0, 0};
  const std::vector<glm::vec3> points = border_points(t, eye, 1e-3f, 7);
  ASSERT_EQ(points.size(), 9u + 3 * 7u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_FALSE(ray_meets(t, eye, points[i])) << i;
    EXPECT_TRUE(ray_meets(t, eye, glm::mix(points[i], (t[0] + t[1] + t[2]) / 3.0f, 0.1f))) << i << " closely";
    EXPECT_LT(glm::length(points[i] - points[(i + 1) % points.size()]), 0.4f);
  }
}

TEST(gvs_plus_plus, edge_points_lie_on_all_twelve_edges) {
  const box cell{{0, 0, 0}, {4, 2, 3}};
  const std::vector<glm::vec3> points = edge_points(cell, 5);
  ASSERT_EQ(points.size(), 60u);
  std::set<std::array<float, 3>> different;
  for (const glm::vec3& p : points) {
    int on = 0;
    for (int axis = 0; axis < 3; ++axis) on += p[axis] == cell.min[axis] || p[axis] == cell.max[axis] ? 1 : 0;
    EXPECT_EQ(on, 2);
    different.insert({p.x, p.y, p.z});
  }
  EXPECT_EQ(different.size(), 60u);
}

TEST(gvs_plus_plus, three_poor_iterations_end_a_cell_and_not_one) {
  test::tiny_scene made;
  made.wall_x(5, 1, 3);  // shows its back, so nothing is ever found
  settings how;
  how.rays_per_round = 2'048;
  how.fewest_new = 1;
  how.sampler = "gvs";
  EXPECT_EQ(sample(how, made.finished(), 1).rays, 2'048u);
  how.sampler = "gvs++";
  EXPECT_EQ(sample(how, made.finished(), 1).rays, 3 * 2'048u);
}

}  // namespace
}  // namespace sightcell::bake
