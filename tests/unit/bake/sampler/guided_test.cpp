// gvs and what it is made of: border polygons, reverse eyes, and sets that depend on nothing but settings and places.
#include <gtest/gtest.h>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "sampler/border_sampling.h"
#include "sampler/cell_sampler.h"
#include "sampler/gvs_plus_plus.h"
#include "sampler/random_rays.h"
#include "sampler/ray_finds.h"
#include "sampler/reverse_sampling.h"
#include "search/aim.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

bool inside(const glm::vec3& p, const box& where) {
  return glm::all(glm::greaterThanEqual(p, where.min)) && glm::all(glm::lessThanEqual(p, where.max));
}

bool ray_meets(const triangle& t, const glm::vec3& eye, const glm::vec3& toward) {
  const glm::dvec3 d(toward - eye), a(t[0]), b(t[1]), c(t[2]), o(eye);
  const double u = glm::dot(d, glm::cross(a - o, b - o)), v = glm::dot(d, glm::cross(b - o, c - o)),
               w = glm::dot(d, glm::cross(c - o, a - o));
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

TEST(border_polygon, passes_the_triangle_closely_on_all_sides) {
  random_stream random(1, 1, purpose::verify);
  for (int trial = 0; trial < 200; ++trial) {
    const triangle t{random.in_box({2, -3, -3}, {9, 3, 3}), random.in_box({2, -3, -3}, {9, 3, 3}),
                     random.in_box({2, -3, -3}, {9, 3, 3})};
    const glm::vec3 eye = random.in_box({-1, -1, -1}, {1, 1, 1});
    const float offset = 1e-3f;
    const border_polygon border = enlarged(t, eye, offset);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_FALSE(ray_meets(t, eye, border[i])) << trial << " point " << i;
      double nearest = 1e9;
      for (const glm::vec3& corner : t)
        nearest = std::min(nearest, double(glm::length(border[i] - corner) / glm::length(corner - eye)));
      EXPECT_NEAR(nearest, offset, 1e-5) << "as far from its corner as is said";
    }
    for (std::size_t corner = 0; corner < 3; ++corner)  // three points of each corner, one after the other
      EXPECT_LT(glm::length(border[3 * corner] - border[3 * corner + 2]), 2.1f * offset * 14.0f);
  }
}

TEST(border_polygon, of_a_triangle_under_the_eye_reaches_behind_it) {
  const triangle ground{{{-20, 0, -20}, {20, 0, -20}, {0, 0, 30}}};
  const glm::vec3 eye{0, 1.7f, 0};
  for (const glm::vec3& p : enlarged(ground, eye, 1e-3f)) {
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    EXPECT_FALSE(ray_meets(ground, eye, p) && glm::dot(p - eye, glm::vec3(0, -1, 0)) > 0.0f);
  }
}

TEST(border_polygon, does_not_depend_on_the_corner_that_comes_first) {
  const triangle t{{{3, 0, 0}, {4, 2, 0}, {5, 0, 1}}}, turned{{t[1], t[2], t[0]}};
  EXPECT_EQ(enlarged(t, {0, 0, 0}, 1e-3f), enlarged(turned, {0, 0, 0}, 1e-3f));
}

TEST(sample_border, halves_where_neighbors_met_different_polygons) {
  const triangle t{{{3, 0, 0}, {4, 2, 0}, {5, 0, 1}}};
  const border_polygon border = enlarged(t, {0, 0, 0}, 1e-3f);
  std::vector<glm::vec3> asked;
  const auto same = [&](const glm::vec3& p) {
    asked.push_back(p);
    return border_hit{p, 7, 1.0f};
  };
  sample_border(border, 4, same);
  EXPECT_EQ(asked.size(), 9u);
  // One corner sees something else: on the stretch to each of its neighbors one half goes on differing.
  asked.clear();
  const auto one = [&](const glm::vec3& p) {
    asked.push_back(p);
    return border_hit{p, p == border[4] ? 8u : 7u, 1.0f};
  };
  sample_border(border, 4, one);
  EXPECT_EQ(asked.size(), 9u + 2 * 4u);
  asked.clear();
  std::uint32_t next = 0;
  const auto all = [&](const glm::vec3& p) {
    asked.push_back(p);
    return border_hit{p, next++, 1.0f};
  };
  sample_border(border, 4, all);
  EXPECT_EQ(asked.size(), most_border_rays(4));
}

TEST(reverse_eyes, look_past_both_sides_of_what_blocked_the_ray) {
  const box cell{{0, 0, 0}, {2, 2, 4}};
  // An upright plate between the cell and what lies beside a polygon behind it.
  const triangle plate{{{6, -10, 1.5f}, {6, 30, 1.5f}, {6, 10, 2.5f}}};
  const glm::vec3 eye{2, 1, 2}, seen{10, 1, 0.5f}, border{10, 1, 2};
  std::vector<glm::vec3> eyes;
  add_reverse_eyes(plate, eye, seen, border, 1e-4f, cell, eyes);
  ASSERT_EQ(eyes.size(), 2u);
  for (const glm::vec3& from : eyes) {
    EXPECT_TRUE(inside(from, cell));
    EXPECT_FLOAT_EQ(from.x, 2.0f) << "where it enters";
    EXPECT_FALSE(ray_meets(plate, from, border));
    EXPECT_TRUE(ray_meets(plate, glm::mix(from, eye, 0.1f), border)) << "closely";
  }
}

TEST(reverse_eyes, of_lines_that_pass_the_cell_by_are_not_valid) {
  const triangle plate{{{6, -10, 1.5f}, {6, 30, 1.5f}, {6, 10, 2.5f}}};
  const glm::vec3 eye{2, 1, 2}, seen{10, 1, 0.5f}, border{10, 1, 2};
  std::vector<glm::vec3> eyes;
  add_reverse_eyes(plate, eye, seen, border, 1e-3f, {{0, 0, 1.9f}, {2, 2, 2.05f}}, eyes);
  EXPECT_TRUE(eyes.empty()) << "the cell is too narrow to look past";
  add_reverse_eyes(plate, eye, eye, border, 1e-3f, {{0, 0, 0}, {2, 2, 4}}, eyes);
  EXPECT_TRUE(eyes.empty()) << "three points on a line span no plane";
}

TEST(reverse_eyes, past_what_stands_in_the_cell_lie_between_it_and_the_far_side) {
  const triangle plate{{{1, -10, 1.5f}, {1, 30, 1.5f}, {1, 10, 2.5f}}};
  const box cell{{0, 0, 0}, {2, 2, 4}};
  std::vector<glm::vec3> eyes;
  add_reverse_eyes(plate, {0, 1, 2}, {10, 1, 0.5f}, {10, 1, 2}, 1e-3f, cell, eyes);
  ASSERT_FALSE(eyes.empty());
  for (const glm::vec3& from : eyes) {
    EXPECT_GT(from.x, 0.0f);
    EXPECT_LT(from.x, 1.0f);
  }
}

TEST(is_blocked_before, takes_what_is_clearly_nearer) {
  EXPECT_TRUE(is_blocked_before(9.8f, 10.0f));
  EXPECT_FALSE(is_blocked_before(9.95f, 10.0f));
  EXPECT_FALSE(is_blocked_before(0.985f, 1.0f));
  EXPECT_FALSE(is_blocked_before(std::numeric_limits<float>::infinity(), 10.0f));
}

TEST(join_finds, takes_what_free_eyes_saw_past_no_crack) {
  test::tiny_scene made;
  made.closed_box({-9, -9, -9}, {-1, 9, 9});  // a solid
  made.quad({2, -9, -9}, {2, -9, 0.9995f}, {2, 9, 0.9995f}, {2, 9, -9}, {.double_sided = true});
  made.quad({2, -9, 1.0005f}, {2, -9, 9}, {2, 9, 9}, {2, 9, 1.0005f}, {.double_sided = true});
  const std::uint32_t behind = made.quad({6, -9, -9}, {6, -9, 9}, {6, 9, 9}, {6, 9, -9});
  const scene::world_geometry geometry = scene::flatten(made.finished(), scene::animated_as::always);
  const ray_scene rays(geometry, false);
  const auto joined = [&](std::vector<ray_find> found) {
    cell_set set(static_cast<std::uint32_t>(geometry.kinds.size()));
    const auto seed_rays = join_finds(rays, {}, found, set);
    EXPECT_EQ(seed_rays.size(), set.size());
    return set.members();
  };
  const glm::vec3 x{1, 0, 0};
  const ray_find from_solid{behind - 2, {-2, 0, 4}, x, 4.0f, false}, from_free{behind, {3, 0, 4}, x, 3.0f, false};
  const ray_find through_crack{behind, {0, 0, 1}, x, 6.0f, true};
  const ray_find other{behind + 1, {3, 5, -5}, x, 3.0f, true};
  EXPECT_TRUE(joined({from_solid}).empty());
  EXPECT_TRUE(joined({through_crack}).empty());
  EXPECT_EQ(joined({from_solid, through_crack, from_free}), std::vector<std::uint32_t>{behind});
  EXPECT_EQ(joined({other, from_free}), joined({from_free, other}));
}

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
  bool shared() const override { return true; }
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
    result.rays = sampler->sample({grown, 5, geometry_inside, free}, set).rays;
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

TEST(random_rays, leave_the_boundary_and_start_inside_where_geometry_is) {
  test::tiny_scene made;
  made.wall_x(50, -1, 5);
  const scene::world_geometry geometry = scene::flatten(made.finished(), scene::animated_as::always);
  const ray_scene rays(geometry, false);
  const box cell{{0, 0, 0}, {4, 2, 4}};
  const std::vector<glm::vec3> free{{2, 1, 2}};
  std::vector<random_ray> drawn;
  for (const bool geometry_inside : {false, true}) {
    const random_rays from(rays, {.seed = 1, .place = 2, .geometry_inside = geometry_inside, .interior_share = 0.25},
                           cell, free);
    std::size_t outward = 0, total = 0;
    std::array<std::size_t, 6> faces{};
    for (std::uint64_t stretch = 0; stretch < 400; ++stretch) {
      from.draw(0, stretch, drawn);
      total += drawn.size();
      for (const random_ray& r : drawn) {
        EXPECT_NEAR(glm::length(r.direction), 1.0f, 1e-5f);
        EXPECT_TRUE(inside(r.eye, cell));
        for (int axis = 0; axis < 3; ++axis)
          for (int side = 0; side < 2; ++side)
            if (r.eye[axis] == (side ? cell.max : cell.min)[axis] && r.direction[axis] * (side ? 1.0f : -1.0f) > 0.0f)
              ++outward, ++faces[static_cast<std::size_t>(2 * axis + side)];
      }
    }
    EXPECT_NEAR(static_cast<double>(outward) / static_cast<double>(total), geometry_inside ? 0.75 : 1.0, 1e-3);
    if (!geometry_inside) {
      EXPECT_NEAR(static_cast<double>(faces[0]) / static_cast<double>(total), 8.0 / 64.0, 0.01) << "by area";
      EXPECT_NEAR(static_cast<double>(faces[2]) / static_cast<double>(total), 16.0 / 64.0, 0.01);
    }
  }
}

}  // namespace
}  // namespace sightcell::bake
