// What counts as a miss by pixel, by view and by color, on scenes where the share is known.
#include "bound/metric.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

#include "bound/bound_rays.h"
#include "bound/clopper_pearson.h"
#include "hemicube/surface_colors.h"
#include "search/certify.h"
#include "trace/viewpoints.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

constexpr double degree = std::numbers::pi / 180.0;
// Places so near to each other that all see the same.
const box middle{{-1e-4f, -1e-4f, -1e-4f}, {1e-4f, 1e-4f, 1e-4f}};
constexpr std::uint64_t many = 20'000;

struct world {
  scene::scene s;
  scene::world_geometry geometry;
  ray_scene rays;
  surface_colors colors;
  explicit world(scene::scene from)
      : s(std::move(from)), geometry(scene::flatten(s)), rays(geometry, false), colors(s, geometry) {}

  error_metric by(const metric_settings& how) const { return {how, rays, &colors}; }
  error_metric by(metric_kind kind) const {
    metric_settings how;
    how.kind = kind;
    return by(how);
  }
  verification_batch cast(const error_metric& metric, const std::vector<std::uint32_t>& missing, std::uint64_t seed = 1,
                   std::uint64_t count = many) const {
    return cast_verification_rays(rays, middle, {.metric = &metric}, count, {seed, 1, purpose::bound, 1}, in_all_but(missing));
  }
  static std::function<bool(std::uint32_t)> in_all_but(const std::vector<std::uint32_t>& missing) {
    return [&missing](std::uint32_t p) { return std::find(missing.begin(), missing.end(), p) == missing.end(); };
  }
};

// Within five deviations of a binomial count.
void expect_share(std::uint64_t misses, std::uint64_t rays, double share) {
  const auto n = static_cast<double>(rays);
  EXPECT_NEAR(static_cast<double>(misses) / n, share, 5.0 * std::sqrt(share * (1.0 - share) / n) + 1e-12);
}

// A pixel of it is 4 atan(h^2 / sqrt(1 + 2 h^2)) with h = 1/16 in the middle, and all that a camera shows at any pitch
// is all there is.
metric_settings coarse_view() {
  metric_settings how;
  how.kind = metric_kind::view;
  how.view_width = how.view_height = 16;
  how.view_fov = 90.0;
  return how;
}
const double coarse_pixel = 4.0 * std::atan(1.0 / 256.0 / std::sqrt(1.0 + 2.0 / 256.0));

// The corner of a cube before the eye, an eighth of all directions, and a room around it: the corner alone is missing.
struct octant {
  tiny_scene tiny;
  std::uint32_t room = tiny.closed_box({-3, -3, -3}, {3, 3, 3}, true);
  std::uint32_t corner = tiny.triangle({1, 0, 0}, {0, 0, 1}, {0, 1, 0});
};
const double octant_angle = std::numbers::pi / 2.0;

TEST(view_metric, a_polygon_counts_from_its_least_size_on) {
  octant made;
  const world w(made.tiny.finished());
  metric_settings how = coarse_view();
  how.view_least = 1.01 * octant_angle / coarse_pixel;
  EXPECT_EQ(w.cast(w.by(how), {made.corner}).misses, 0u);
  how.view_least = 0.99 * octant_angle / coarse_pixel;
  const verification_batch counted = w.cast(w.by(how), {made.corner});
  EXPECT_EQ(counted.rays, many);
  expect_share(counted.misses, many, 0.125);
}

TEST(view_metric, knows_sizes_far_below_a_pixel) {
  // Specks of 1e-8 sr all around, 8 m away and turned by 60 degrees, which leaves a half of their area. A pixel of 1920
  // x 1080 is a hundred times as large; single precision is off by a tenth here.
  const float leg = std::sqrt(2.0f * 2.0f * 64.0f * 1e-8f);
  constexpr std::uint32_t specks = 200;
  tiny_scene tiny;
  random_stream random(1, 2, purpose::verify);
  for (std::uint32_t i = 0; i < specks; ++i) {
    const glm::vec3 toward = random.on_sphere(), across = glm::normalize(glm::cross(toward, random.on_sphere()));
    const glm::vec3 along = std::sqrt(0.75f) * toward + 0.5f * glm::cross(toward, across), at = 8.0f * toward;
    tiny.triangle(at, at + leg * across, at + leg * along);
  }
  const world w(tiny.finished());
  metric_settings how = coarse_view();
  for (const double of_it : {0.98, 1.02}) {
    how.view_least = of_it * 1e-8 / coarse_pixel;
    const error_metric metric = w.by(how);
    for (std::uint32_t i = 0; i < specks; ++i) EXPECT_EQ(metric.is_large(i, {0, 0, 0}), of_it < 1.0) << i;
  }
  EXPECT_TRUE(pixel_metric.is_large(0, {0, 0, 0}));
  EXPECT_TRUE(w.by(metric_kind::color).is_large(0, {0, 0, 0}));
}

TEST(view_metric, one_large_polygon_of_those_a_ray_lacks_is_enough) {
  // Before the corner a pane that is too small, and 0.06 mm before it, so in its place, a sheet that is.
  octant made;
  const auto pane =
      made.tiny.triangle({0.3f, 0.1f, 0.1f}, {0.1f, 0.1f, 0.3f}, {0.1f, 0.3f, 0.1f}, {scene::alpha_mode::blend, true});
  const auto third = [](float x, float y, float z) { return 0.9999f * glm::vec3{x, y, z} / 3.0f; };
  const auto same = made.tiny.triangle(third(1.2f, 0.9f, 0.9f), third(0.9f, 0.9f, 1.2f), third(0.9f, 1.2f, 0.9f));
  const world w(made.tiny.finished());
  metric_settings how = coarse_view();
  how.view_least = 0.99 * octant_angle / coarse_pixel;
  const error_metric metric = w.by(how);
  ASSERT_FALSE(metric.is_large(pane, {0, 0, 0}) || metric.is_large(same, {0, 0, 0}));
  EXPECT_EQ(w.cast(metric, {pane}).misses, 0u);
  EXPECT_EQ(w.cast(metric, {same}).misses, 0u) << "excused by the corner";
  const std::uint64_t alone = w.cast(metric, {made.corner, same}).misses;
  expect_share(alone, many, 0.125);
  how.view_least = 0.0;
  EXPECT_EQ(alone, w.cast(w.by(how), {made.corner, same}).misses) << "also where the sheet is in front";
  const verification_batch both = w.cast(metric, {made.corner, same, pane});
  EXPECT_EQ(both.misses, alone) << "the same rays, through the pane or not";
  EXPECT_GT(both.missed.size(), alone) << "what is too small joins, too";
}

TEST(view_metric, looks_where_pictures_look) {
  tiny_scene tiny;
  const auto room = tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  const world w(tiny.finished());
  const std::vector<std::uint32_t> ceiling{room + 6, room + 7}, wall{room + 8, room + 9};
  for (const std::uint32_t p : ceiling)
    for (const float y : {0.0f, 1.9f}) EXPECT_TRUE(faces(w.rays, p, {0, y, 0}) && !faces(w.rays, p, {0, 2.1f, 0}));
  metric_settings how = coarse_view();
  expect_share(w.cast(w.by(how), ceiling).misses, many, 1.0 / 6.0);
  // A camera that looks straight on sees 35 degrees up, and the corners of the ceiling begin a little higher.
  how.view_pitch = {0.0, 0.0};
  how.view_fov = 70.0;
  EXPECT_EQ(w.cast(w.by(how), ceiling).misses, 0u);
  expect_share(w.cast(w.by(how), wall).misses, many, 0.25);
  how.view_pitch = {0.0, 20.0};
  EXPECT_GT(w.cast(w.by(how), ceiling).misses, 0u);
}

// Heights of directions: their sines.
std::vector<double> heights(const error_metric& metric, int count) {
  std::vector<double> drawn;
  random_stream random(1, 2, purpose::bound);
  for (int i = 0; i < count; ++i) {
    const glm::vec3 d = metric.direction(random);
    EXPECT_NEAR(glm::length(d), 1.0f, 1e-5f);
    drawn.push_back(static_cast<double>(d.y));
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

TEST(view_metric, hints_weigh_what_pictures_show) {
  octant made;
  const world w(made.tiny.finished());
  metric_settings how = coarse_view();
  how.view_pitch = {-15.0, 45.0};  // from -60 to 90 degrees
  const double share = 0.5 * (1.0 + std::sin(60.0 * degree));
  const auto weight = [&](std::uint32_t polygon, const glm::vec3& toward) {
    return w.by(how).weight(polygon, {{0, 0, 0}, glm::normalize(toward)}, [](std::uint32_t) { return true; });
  };
  how.view_least = 0.9 * octant_angle / coarse_pixel;
  EXPECT_NEAR(weight(made.corner, {1, 1, 1}), 1.0 / share, 1e-6);
  EXPECT_EQ(weight(made.corner, {1, -3, 1}), 0.0) << "65 degrees down";
  how.view_least = 1.1 * octant_angle / coarse_pixel;
  EXPECT_EQ(weight(made.corner, {1, 1, 1}), 0.0);
}

TEST(view_metric, the_band_is_what_a_picture_can_hold) {
  tiny_scene tiny;
  tiny.wall_x(2, -1, 1);
  const world w(tiny.finished());
  metric_settings how;
  how.kind = metric_kind::view;
  constexpr int count = 200'000;
  struct band {
    double down, up, low, high;
  };
  // The picture's upper corner, 16 : 9, of a camera that looks down by 60 degrees or more.
  const double t = std::tan(30.0 * degree), corner = std::sqrt(1.0 + t * t * (1.0 + 256.0 / 81.0));
  const double below = (std::sin(-60.0 * degree) + t * std::cos(-60.0 * degree)) / corner;
  for (const band& b :
       {band{-90, 90, -1, 1}, band{-10, 20, std::sin(-40.0 * degree), std::sin(50.0 * degree)},
        band{-70, -20, -1, std::sin(10.0 * degree)}, band{-90, -60, -1, below}, band{60, 90, -below, 1}}) {
    how.view_pitch = {b.down, b.up};
    const std::vector<double> drawn = heights(w.by(how), count);
    const double span = b.high - b.low;
    EXPECT_GE(drawn.front(), b.low - 1e-6);
    EXPECT_LE(drawn.back(), b.high + 1e-6);
    // Uniform by solid angle is uniform in the sine (Kolmogorov and Smirnov's distance, far beyond chance).
    double most = 0.0;
    for (int i = 0; i < count; ++i)
      most = std::max(most, std::abs((drawn[static_cast<std::size_t>(i)] - b.low) / span - (i + 0.5) / count));
    EXPECT_LT(most, 2.5 / std::sqrt(count));
  }
}

TEST(view_metric, directions_go_all_around) {
  tiny_scene tiny;
  tiny.wall_x(2, -1, 1);
  const world w(tiny.finished());
  metric_settings how = coarse_view();
  how.view_pitch = {10.0, 10.0};
  const error_metric metric = w.by(how);
  random_stream random(1, 2, purpose::bound);
  std::array<std::uint64_t, 8> around{};
  for (std::uint64_t i = 0; i < many; ++i) {
    const glm::vec3 d = metric.direction(random);
    const double turn = (std::atan2(static_cast<double>(d.z), static_cast<double>(d.x)) / std::numbers::pi + 1.0) * 4.0;
    ++around[static_cast<std::size_t>(turn) % 8];
  }
  for (const std::uint64_t count : around) expect_share(count, many, 0.125);
}

// A room whose colors are given: walls, and an octant before the eye.
struct painted {
  octant made;
  std::uint32_t corner = made.corner;

  world with(const glm::vec4& room, const glm::vec4& of_corner, scene::alpha_mode alpha = scene::alpha_mode::opaque) {
    scene::scene s = made.tiny.finished();
    s.materials[0].base_color = room;
    s.materials[1].base_color = of_corner;
    s.materials[1].alpha = alpha;
    s.materials[1].double_sided = true;
    scene::finish(s);
    return world(std::move(s));
  }
};
const glm::vec4 black{0, 0, 0, 1}, white{1, 1, 1, 1}, red{1, 0, 0, 1};
const glm::vec4 half{glm::vec3{0.21586050f}, 1};  // 128 of 255 as sRGB

TEST(color_metric, counts_by_how_much_the_color_differs) {
  struct {
    glm::vec4 behind, before;
    double difference;
  } const cases[] = {
      {white, white, 0.0},     {red, red, 0.0},         {white, black, 1.0},          {black, white, 1.0},
      {black, red, 1.0 / 3.0}, {white, red, 2.0 / 3.0}, {black, half, 128.0 / 255.0},
  };
  for (const auto& one : cases) {
    painted scene;
    const world w = scene.with(one.behind, one.before);
    const verification_batch plain = w.cast(pixel_metric, {scene.corner});
    const verification_batch batch = w.cast(w.by(metric_kind::color), {scene.corner});
    expect_share(batch.misses, many, one.difference / 8.0);
    EXPECT_EQ(batch.misses == 0, one.difference == 0.0);
    // All that is missing joins, whatever it looks like: about as many rays see it.
    expect_share(batch.missed.size(), many, 0.125);
    EXPECT_EQ(batch.misses == batch.missed.size(), one.difference == 1.0);
    EXPECT_EQ(plain.misses, plain.missed.size());
    std::uint64_t counting = 0;
    for (const missed_polygon& m : batch.missed) counting += m.counts;
    EXPECT_EQ(counting, batch.misses);
  }
}

TEST(color_metric, hints_weigh_what_differs) {
  painted scene;
  const world w = scene.with(black, red);
  const auto weight = [&](std::uint32_t polygon, const std::vector<std::uint32_t>& missing) {
    return w.by(metric_kind::color)
        .weight(polygon, {{0, 0, 0}, glm::normalize(glm::vec3{1, 1, 1})}, world::in_all_but(missing));
  };
  EXPECT_NEAR(weight(scene.corner, {scene.corner}), 1.0 / 3.0, 1e-9);
  EXPECT_EQ(weight(scene.corner, {}), 0.0);
  std::vector<std::uint32_t> all(w.s.polygon_count);
  std::iota(all.begin(), all.end(), 0u);
  const glm::vec3 off = glm::abs(glm::vec3(surface_colors::sky()) - glm::vec3{255, 0, 0}) / 255.0f;
  EXPECT_NEAR(weight(scene.corner, all), static_cast<double>(off.x + off.y + off.z) / 3.0, 1e-6);
}

TEST(color_metric, the_sky_is_a_color_too) {
  const glm::vec3 sky = glm::vec3(surface_colors::sky()) / 255.0f;
  tiny_scene tiny;
  const auto corner = tiny.triangle({1, 0, 0}, {0, 0, 1}, {0, 1, 0});
  scene::scene s = tiny.finished();
  s.materials[0].base_color = black;
  const world w(std::move(s));
  expect_share(w.cast(w.by(metric_kind::color), {corner}).misses, many,
               static_cast<double>(sky.x + sky.y + sky.z) / 3.0 / 8.0);
}

TEST(color_metric, what_hides_nothing_counts_as_if_it_were_opaque) {
  painted scene;
  const world glass = scene.with(black, half, scene::alpha_mode::blend);
  expect_share(glass.cast(glass.by(metric_kind::color), {scene.corner}).misses, many, 128.0 / 255.0 / 8.0);
  const world unseen = scene.with(red, red, scene::alpha_mode::blend);
  EXPECT_EQ(unseen.cast(unseen.by(metric_kind::color), {scene.corner}).misses, 0u);
  // A pane of the set before what is missing changes nothing; behind it, it is what one sees instead.
  for (const float scale : {0.5f, 2.0f}) {
    octant made;
    made.tiny.triangle({scale, 0, 0}, {0, 0, scale}, {0, scale, 0}, {scene::alpha_mode::blend, true});
    scene::scene s = made.tiny.finished();
    s.materials[0].base_color = s.materials[1].base_color = black;
    s.materials[2].base_color = half;
    const world w(std::move(s));
    expect_share(w.cast(w.by(metric_kind::color), {made.corner}).misses, many,
                 scale < 1.0f ? 0.0 : 128.0 / 255.0 / 8.0);
  }
}

TEST(color_metric, bounds_hold) {
  painted scene;
  const world w = scene.with(black, red);
  const error_metric metric = w.by(metric_kind::color);
  int below = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const verification_batch batch = w.cast(metric, {scene.corner}, seed, 500);
    below += clopper_pearson_upper(batch.misses, batch.rays, 0.95) < 1.0 / 24.0;
  }
  EXPECT_LE(below, 10 + 6);  // 5 % of 200, plus two standard errors
  EXPECT_GE(below, 1) << "and they are bounds of this";
}

// A picture of all kinds of misses: small, large, of several colors, through glass.
world mixed() {
  tiny_scene tiny;
  tiny.closed_box({-3, -3, -3}, {3, 3, 3}, true);
  for (int i = 0; i < 24; ++i) {
    const float at = -2.4f + 0.2f * static_cast<float>(i), size = 0.02f * static_cast<float>(i + 1);
    tiny.triangle({1.5f, at, at}, {1.5f, at, at + size}, {1.5f, at + size, at},
                  {i % 3 == 0 ? scene::alpha_mode::blend : scene::alpha_mode::opaque, true});
  }
  scene::scene s = tiny.finished();
  for (std::size_t i = 0; i < s.materials.size(); ++i)
    s.materials[i].base_color = {static_cast<float>(i % 4) / 3.0f, static_cast<float>(i % 3) / 2.0f, 0.5f, 1.0f};
  scene::finish(s);
  return world(std::move(s));
}

TEST(error_metric, does_not_depend_on_threads) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 4);
  const world w = mixed();
  metric_settings view = coarse_view();
  view.view_pitch = {-30.0, 30.0};
  for (const error_metric& metric : {w.by(view), w.by(metric_kind::color)}) {
    const auto cast = [&](int threads, bool fresh) {
      verification_batch batch;
      tbb::task_arena arena(threads);
      const visibility_rules rules{.metric = &metric};
      const auto lacks_some = [](std::uint32_t p) { return p < 12 || p % 4 == 0; };
      const box around{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};
      arena.execute([&] {
        batch = fresh ? cast_verification_rays(w.rays, around, rules, 20'000, {1, 1, purpose::bound, 1}, lacks_some)
                      : cast_bound_rays(w.rays, around, rules, {.trials = 20'000, .valid_share = 1.0, .risk = 0.01},
                                        {1, 1, purpose::bound, 1}, lacks_some);
      });
      return batch;
    };
    for (const bool fresh : {false, true}) {
      const verification_batch one = cast(1, fresh), four = cast(4, fresh);
      EXPECT_GT(one.misses, 0u);
      EXPECT_LT(one.misses, one.missed.size());
      EXPECT_EQ(one.rays, four.rays);
      EXPECT_EQ(one.misses, four.misses);
      ASSERT_EQ(one.missed.size(), four.missed.size());
      for (std::size_t i = 0; i < one.missed.size(); ++i) {
        EXPECT_EQ(one.missed[i].eye, four.missed[i].eye);
        EXPECT_EQ(one.missed[i].counts, four.missed[i].counts);
      }
    }
  }
}

TEST(error_metric, batches_of_the_bound_measure_the_same) {
  painted scene;
  const world w = scene.with(black, red);
  const error_metric metric = w.by(metric_kind::color);
  const auto batch =
      cast_bound_rays(w.rays, middle, {.metric = &metric}, {.trials = many, .valid_share = 1.0, .risk = 0.01},
                      {1, 1, purpose::bound, 1}, world::in_all_but({scene.corner}));
  expect_share(batch.misses, many, 1.0 / 24.0);
  metric_settings how = coarse_view();
  for (const double up : {90.0, -60.0}) {
    how.view_pitch = {-90.0, up};
    const error_metric view = w.by(how);
    const auto seen =
        cast_bound_rays(w.rays, middle, {.metric = &view}, {.trials = many, .valid_share = 1.0, .risk = 0.01},
                        {1, 1, purpose::bound, 1}, world::in_all_but({scene.corner}));
    expect_share(seen.misses, many, up > 0.0 ? 0.125 : 0.0);
  }
}

// The corner is all that is missing, and rays from beside it never find it: it shares no vertex with anything.
finish_result finish(const world& w, const error_metric& metric, std::uint32_t missing, cell_set& set) {
  const near_polygons neighbors(w.rays);
  for (std::uint32_t p = 0; p < w.s.polygon_count; ++p)
    if (p != missing) set.add(p, {0, 0, 0});
  return finish_with_rays(w.rays, neighbors, middle, {.max_pixel_error = 1e-3, .rules = {.metric = &metric}}, set);
}

TEST(error_metric, the_bound_is_reached_by_what_counts) {
  painted scene;
  const world w = scene.with(white, white);
  const error_metric color = w.by(metric_kind::color);
  cell_set plain(w.s.polygon_count), colored(w.s.polygon_count);
  const finish_result by_pixel = finish(w, pixel_metric, scene.corner, plain);
  EXPECT_TRUE(by_pixel.bound_met);
  EXPECT_GT(by_pixel.confidence, 0.99) << "the first look missed the corner, a later one met the bound";
  const finish_result by_color = finish(w, color, scene.corner, colored);
  EXPECT_TRUE(by_color.bound_met);
  EXPECT_EQ(by_color.misses, 0u);
  EXPECT_NEAR(by_color.confidence, 0.9875, 1e-12) << "its first look did";
  EXPECT_TRUE(plain.contains(scene.corner));
  EXPECT_TRUE(colored.contains(scene.corner)) << "what is seen joins, whether it counts or not";
}

}  // namespace
}  // namespace sightcell::bake
