#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "hemicube/choice/choose_source.h"
#include "hemicube/surface_colors.h"
#include "search/cell_search.h"
#include "search/guided_views.h"
#include "unit/bake/cards_with_flaps.h"
#include "unit/bake/gridded_room.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

// A room of 8 x 8 x 8 m whose floor is divided by low walls, with pillars between: from each place only some is seen.
tiny_scene maze() {
  tiny_scene tiny;
  tiny.closed_box({-4, -4, -4}, {4, 4, 4}, true);
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) {
      const float x = static_cast<float>(i), z = static_cast<float>(j);
      tiny.closed_box({x - 0.2f, -4, z - 0.2f}, {x + 0.2f, -1, z + 0.2f}, false);
      tiny.closed_box({x + 0.3f, -3.9f, z + 0.3f}, {x + 0.35f, -3.85f, z + 0.35f}, false);
    }
  return tiny;
}

struct world {
  scene::scene s;
  scene::world_geometry geometry = scene::flatten(s);
  ray_scene rays{geometry, false};
  near_polygons neighbors{rays};
  chosen_source eyes;

  explicit world(scene::scene of = maze().finished(), std::uint32_t resolution = 64)
      : s(std::move(of)), eyes(choose_source(drawn_by_us(resolution), geometry, rays)) {}

  static settings drawn_by_us(std::uint32_t resolution) {
    settings how;
    how.source = "cpu";
    how.resolution = resolution;
    return how;
  }
};

const box cell{{-2.05f, -3.0f, -0.6f}, {2.05f, -2.0f, 0.6f}};

guided_settings places_of(bool geometry_inside, std::uint32_t taken = 0) {
  return {.seed = 3, .place = 7, .geometry_inside = geometry_inside, .resolution = 64, .taken = taken};
}

TEST(guided_views, stand_in_free_places_and_go_on_where_they_ended) {
  const world w;
  guided_views views(w.rays, cell, places_of(true));
  const std::vector<pose> first = views.next(60);
  ASSERT_EQ(first.size(), 60u);
  EXPECT_EQ(views.taken(), 60u);
  guided_views later(w.rays, cell, places_of(true, 60));
  const std::vector<pose> second = later.next(60);
  std::set<std::tuple<float, float, float>> eyes;
  int inside = 0;
  for (const auto& poses : {first, second})
    for (const pose& p : poses) {
      EXPECT_TRUE(w.rays.is_valid(p.eye, 0.05f));
      EXPECT_NEAR(glm::length(glm::cross(p.forward, p.up) - p.right), 0.0f, 1e-5f);
      eyes.insert({p.eye.x, p.eye.y, p.eye.z});
      bool on_a_face = false;
      for (int k = 0; k < 3; ++k) on_a_face = on_a_face || p.eye[k] == cell.min[k] || p.eye[k] == cell.max[k];
      inside += on_a_face ? 0 : 1;
    }
  EXPECT_EQ(inside, 28) << "a quarter of each sixty, two by two";
  EXPECT_GE(eyes.size(), 100u) << "two hemicubes of a cube share their eye, no others";
}

TEST(guided_views, every_second_turn_is_rotated_and_all_are_jittered) {
  const world w;
  guided_views views(w.rays, {{-0.4f, 0.0f, -0.4f}, {0.4f, 0.8f, 0.4f}}, places_of(false));
  const std::vector<pose> poses = views.next(12);
  ASSERT_EQ(poses.size(), 12u);
  int straight = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    float most = 0.0f;  // 1: along an axis
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(poses[i].up[k]));
    EXPECT_EQ(most > 0.9f, i < 6) << i;
    for (int k = 0; k < 3; ++k) straight += poses[i].forward[k] == 1.0f || poses[i].forward[k] == -1.0f;
  }
  EXPECT_EQ(straight, 0);
}

TEST(guided_views, find_the_only_free_corner_and_end_where_there_is_none) {
  tiny_scene tiny;
  tiny.closed_box({-1, -1, -1}, {1, 1, 1}, false);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  guided_views outside(rays, {{-1.02f, -0.9f, -0.9f}, {0.9f, 0.9f, 0.9f}}, places_of(true));
  EXPECT_TRUE(outside.next(6).empty()) << "2 cm are no place for an eye that keeps 5 cm off";
  guided_views corner(rays, {{-1.06f, -0.9f, -0.9f}, {0.9f, 0.9f, 0.9f}},
                      {.seed = 3, .place = 7, .geometry_inside = true});
  for (const pose& p : corner.next(6)) EXPECT_LT(p.eye.x, -1.05f);
}

// The bound's rays never start there; judges that draw other directions may find such a place free.
TEST(guided_views, stand_in_solids_by_a_little_too) {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  tiny.wall_x(2, 1, 2);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  const box around{{-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}};
  guided_views views(rays, around, places_of(false));
  const std::vector<pose> poses = views.next(6);
  EXPECT_EQ(poses.size(), 6u);
  for (const pose& p : poses) EXPECT_FALSE(rays.is_valid(p.eye, 0.05f));
}

TEST(guided_views, add_cubes_where_they_are_asked_to) {
  const world w;
  const std::vector<glm::vec3> eyes{{-1.5f, -2.5f, 0.5f}, {1.5f, -2.5f, 0.5f}};
  guided_views views(w.rays, cell, places_of(true)), others(w.rays, cell, places_of(true));
  const std::vector<pose> cubes = views.cubes_at(eyes), again = views.cubes_at(eyes);
  ASSERT_EQ(cubes.size(), 4u);
  EXPECT_EQ(views.taken(), 8u);
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    EXPECT_EQ(cubes[i].eye, eyes[i / 2]);
    EXPECT_NE(cubes[i].forward, again[i].forward) << "each has pixels of its own";
    EXPECT_GT(std::abs(cubes[i].forward.z), 0.99f);
    EXPECT_LT(cubes[i].forward.z * cubes[i ^ 1].forward.z, 0.0f) << "back to back";
  }
  const std::vector<pose> after = views.next(6), without = others.next(6);
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].eye, without[i].eye) << i;
}

TEST(cell_search, takes_as_many_hemicubes_again_until_it_is_enough) {
  const world w;
  search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source};
  cell_set set(w.s.polygon_count);
  cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .priority = 1e-6}, set);
  std::vector<double> said;
  std::vector<std::uint64_t> costs;
  search.look_for({.enough = [&](const error_guess& missing, std::uint64_t cost) {
    said.push_back(missing.back());
    costs.push_back(cost);
    return said.size() == 4;
  }});
  EXPECT_EQ(views.poses.taken(), 24u + 24u + 48u);
  ASSERT_EQ(said.size(), 4u);
  EXPECT_EQ(said[0], 1.0);
  EXPECT_EQ(said[1], 1.0) << "of the first round all is new: that says nothing";
  EXPECT_LT(said[2], 0.1);
  EXPECT_LE(said[3], said[2]);
  EXPECT_GT(costs[1], costs[0]) << "hemicubes cost by what they see, too";
  EXPECT_NEAR(static_cast<double>(costs[2]), 2.0 * static_cast<double>(costs[1]), 0.2 * static_cast<double>(costs[1]))
      << "the next round is as large as all before it";
  EXPECT_GE(search.spent(), costs[0] + costs[1] + costs[2]);
}

TEST(cell_search, takes_half_as_many_where_rays_rarely_hit) {
  for (const int n : {10, 50}) {
    const world w(test::cards_with_flaps(n).finished(), 128);
    search_views views{guided_views(w.rays, cell, {.seed = 3, .place = 7, .resolution = 128}), *w.eyes.source, 110};
    cell_set set(w.s.polygon_count);
    cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .priority = 1e-6}, set);
    std::vector<std::uint32_t> taken;
    search.look_for({.enough = [&](const error_guess&, std::uint64_t) {
      taken.push_back(views.poses.taken());
      return false;
    }});
    taken.push_back(views.poses.taken());
    search.hear(1e-3);
    if (n == 10) {
      EXPECT_EQ(taken, (std::vector<std::uint32_t>{0, 24, 48, 96, 110}));
      EXPECT_NEAR(search.missing().front(), 4e-4, 1e-9);
    } else {
      EXPECT_EQ(taken, (std::vector<std::uint32_t>{0, 24, 48, 72, 108, 110}));
      EXPECT_NEAR(search.missing().front(), 8e-4, 1e-9) << "rays beside the misses find little";
    }
  }
}

TEST(cell_search, casts_rays_for_half_of_the_batch_that_follows) {
  const world w(test::gridded_room(30).finished(), 16);
  const auto rays = [&](double cost_of_batch) {
    search_views views{guided_views(w.rays, test::room_middle, {.resolution = 16}), *w.eyes.source};
    cell_set set(w.s.polygon_count);
    cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .priority = 1e-2}, set);
    search.look_for({.enough = [&](const error_guess&, std::uint64_t) { return views.poses.taken() > 0; },
                     .cost_of_batch =
                         [&](double missing) {
                           EXPECT_EQ(missing, search.missing()[2]);
                           return cost_of_batch;
                         }});
    EXPECT_EQ(views.poses.taken(), 24u);
    return search.rays();
  };
  const std::uint64_t some = rays(1'000.0), all = rays(1e12);
  EXPECT_EQ(rays(0.0), 0u) << "hemicubes show all that is wider than this priority";
  EXPECT_GE(some, 500u);
  EXPECT_LT(some, 1'000u) << "half, to within a step of the priority";
  EXPECT_GT(all, 2 * some) << "no endless search";
}

TEST(cell_search, ends_where_no_hemicube_is_left_and_the_time_is_over) {
  const world w;
  search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, 0};
  cell_set set(w.s.polygon_count);
  const time_limit over(1e-9, true);
  cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .limit = &over, .priority = 1e-2}, set);
  set.add(0, {0.0f, -2.5f, 0.0f});
  search.look_for({.cost_of_batch = [](double) { return 1e12; }});
  EXPECT_EQ(search.rays(), 0u);
}

TEST(cell_search, takes_cubes_where_many_rays_missed) {
  const world w;
  const auto taken = [&](int missed, std::uint32_t most) {
    std::vector<glm::vec3> eyes;
    for (int i = missed; i-- > 0;) eyes.push_back({0.05f * static_cast<float>(i % 40) - 1.0f, -2.5f, 0.5f});
    search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, most};
    cell_set set(w.s.polygon_count);
    cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .priority = 1e-6}, set);
    search.look_from(eyes, 1'000'000'000);
    EXPECT_EQ(set.eyes().size(), views.poses.taken());
    EXPECT_EQ(search.spent() > 0, views.poses.taken() > 0);
    for (const glm::vec3& eye : set.eyes()) EXPECT_NE(std::find(eyes.begin(), eyes.end(), eye), eyes.end());
    const std::vector<glm::vec3> used = set.eyes();
    if (missed == 40 && most > 16) {
      EXPECT_EQ(used.front(), eyes.back());
      EXPECT_EQ(used.back(), eyes[4]) << "spread over all";
    }
    return views.poses.taken();
  };
  constexpr std::uint32_t no_limit = 0xFFFFFFFFu;
  EXPECT_EQ(taken(7, no_limit), 0u) << "rays beside a few misses are enough";
  EXPECT_EQ(taken(8, no_limit), 16u);
  EXPECT_EQ(taken(40, no_limit), 16u);
  EXPECT_EQ(taken(47, no_limit), 16u) << "seven twice";
  EXPECT_EQ(taken(40, 9), 8u) << "two hemicubes per cube";
  EXPECT_EQ(taken(40, 0), 0u);
}

TEST(cell_search, what_is_too_small_for_the_view_is_not_missing) {
  const world w;
  metric_settings view;
  view.kind = metric_kind::view;
  const auto missing = [&](const error_metric& metric) {
    search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, 48};
    cell_set set(w.s.polygon_count);
    cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .metric = &metric, .priority = 1e9}, set);
    search.look_for({});
    EXPECT_EQ(views.poses.taken(), 48u);
    return search.missing().back();
  };
  const double plain = missing(pixel_metric);
  EXPECT_GT(plain, 0.0);
  view.view_least = 0.0;
  EXPECT_EQ(missing(error_metric(view, w.rays, nullptr)), plain);
  view.view_least = 1e4;  // 0.01 sr
  const double large = missing(error_metric(view, w.rays, nullptr));
  EXPECT_LT(large, plain);
  view.view_least = 1e6;
  EXPECT_LT(missing(error_metric(view, w.rays, nullptr)), large);
}

TEST(cell_search, what_looks_the_same_is_not_missing_by_color) {
  const world w;
  metric_settings color;
  color.kind = metric_kind::color;
  const surface_colors colors(w.s, w.geometry);
  const error_metric metric(color, w.rays, &colors);
  const auto missing = [&](const error_metric& by) {
    search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, 48};
    cell_set set(w.s.polygon_count);
    cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .metric = &by, .priority = 1e9}, set);
    search.look_for({});
    return search.missing().back();
  };
  EXPECT_LT(missing(metric), 0.2 * missing(pixel_metric)) << "all is white, but for the sky where nothing is known";
}

TEST(cell_search, spends_its_hemicubes_and_no_more) {
  const world w;
  search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, 37};
  cell_set set(w.s.polygon_count);
  cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .priority = 1e-6}, set);
  search.look_for({});
  EXPECT_EQ(views.poses.taken(), 37u);
  EXPECT_GT(search.rays(), 0u);
}

TEST(cell_search, takes_one_turn_of_hemicubes_without_time) {
  const world w;
  for (const bool around : {false, true}) {
    search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, 37};
    cell_set set(w.s.polygon_count);
    const time_limit none_left(1e-9, true);
    cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .limit = &none_left, .priority = 1e-6},
                       set);
    for (int i = 0; i < 2; ++i) around ? search.look_around() : search.look_for({});
    EXPECT_EQ(views.poses.taken(), 6u);
    EXPECT_GT(set.size(), 6u);
  }
}

TEST(cell_search, finds_the_same_on_any_number_of_threads) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 4);
  const world w;
  const auto look = [&](int threads) {
    search_views views{guided_views(w.rays, cell, places_of(true)), *w.eyes.source, 48};
    cell_set set(w.s.polygon_count);
    tbb::task_arena arena(threads);
    arena.execute([&] {
      cell_search search(w.rays, w.neighbors, &views, {.seed = 1, .place = 7, .priority = 1e-7}, set);
      search.look_for({});
    });
    return set.sorted();
  };
  EXPECT_EQ(look(1), look(4));
}

TEST(cell_search, rays_alone_where_there_are_no_hemicubes) {
  const world w;
  cell_set set(w.s.polygon_count);
  set.add(0, {0.5f, -2.5f, 0.5f});
  cell_search search(w.rays, w.neighbors, nullptr, {.seed = 1, .place = 7, .priority = 1e-6}, set);
  EXPECT_EQ(search.cost_of_views(), 0u);
  search.look_for({});
  EXPECT_EQ(search.missing().back(), 1.0);
  EXPECT_GT(set.size(), 1u);
}

}  // namespace
}  // namespace sightcell::bake
