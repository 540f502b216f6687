// What a source notes besides who is seen: pixels, the first of them, importance, the image, and the same of each.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>

#include "errors/error_id.h"
#include "hemicube/choice/choose_source.h"
#include "hemicube/gpu/polygon_counts.h"
#include "hemicube/hemicube_faces.h"
#include "hemicube/rays/rays_source.h"
#include "hemicube/source_on_thread.h"
#include "trace/ray_scene.h"
#include "unit/bake/hemicube/all_sources.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using namespace sightcell::test;
using look = tiny_scene::look;

constexpr std::uint32_t size = source_test_size;
const look pane{scene::alpha_mode::blend, false};
const look both_sides{scene::alpha_mode::opaque, true};

class source_view_test : public source_test {};

// One polygon toward each of the five faces and one behind; the pose is turned, so that no axis is special.
TEST_P(source_view_test, each_face_sees_what_lies_there) {
  bake::pose from;
  from.eye = {10, 20, -5};
  from.forward = glm::normalize(glm::vec3(1, 2, -2));
  from.up = glm::normalize(glm::cross(from.forward, glm::vec3(0.3f, 1, 0.1f)));
  from.right = glm::cross(from.forward, from.up);

  tiny_scene s;
  const auto toward = [&](const glm::vec3& direction) {
    const glm::vec3 center = from.eye + 3.0f * direction;
    const glm::vec3 u = 0.4f * glm::normalize(glm::cross(direction, glm::vec3(0.1f, 0.9f, 0.3f)));
    const glm::vec3 v = 0.4f * glm::normalize(glm::cross(direction, u));
    return s.triangle(center - u - v, center + u - v, center + v, both_sides);
  };
  // Slightly forward, inside the half that is kept.
  const glm::vec3 f = from.forward;
  const std::vector<std::uint32_t> ahead{
      toward(f), toward(glm::normalize(from.right + 0.3f * f)), toward(glm::normalize(-from.right + 0.3f * f)),
      toward(glm::normalize(from.up + 0.3f * f)), toward(glm::normalize(-from.up + 0.3f * f))};
  const auto behind = toward(-f);
  const auto behind_beside = toward(glm::normalize(from.right - 0.3f * f));
  const auto view = look_at(s, from);
  for (const auto id : ahead) EXPECT_TRUE(sees(view, id)) << id;
  EXPECT_FALSE(sees(view, behind));
  EXPECT_FALSE(sees(view, behind_beside));
}

TEST_P(source_view_test, in_a_closed_box_every_pixel_belongs_to_a_polygon) {
  tiny_scene s;
  s.closed_box({-3, -2, -4}, {5, 3, 2}, true);
  bake::pose from = along_x;
  from.eye = {0.3f, 0.2f, -0.7f};
  EXPECT_EQ(all_pixels(look_at(s, from)), 3u * size * size);
  from.forward = glm::normalize(glm::vec3(0.4f, 0.3f, -0.8f));
  from.right = glm::normalize(glm::cross(from.forward, glm::vec3(0, 1, 0)));
  from.up = glm::cross(from.right, from.forward);
  EXPECT_EQ(all_pixels(look_at(s, from)), 3u * size * size);
}

TEST_P(source_view_test, ids_are_ascending_and_unique) {
  tiny_scene s;
  for (int i = 0; i < 20; ++i) {
    const float distance = 20.0f - static_cast<float>(i);  // the farther the larger, so that all are seen
    s.wall_x(distance, -1, 0.05f * distance * distance, i % 2 == 0 ? pane : look{});
  }
  const auto view = look_at(s);
  EXPECT_EQ(view.seen.size(), 40u);
  for (std::size_t i = 1; i < view.seen.size(); ++i) EXPECT_LT(view.seen[i - 1].id, view.seen[i].id);
}

TEST_P(source_view_test, importance_is_larger_toward_the_side_of_the_gap) {
  // A near wall covers the left of the view (z < 0); the far one shows right of it. Nothing else ends in the view.
  const float end = 1000.0f;
  tiny_scene s;
  s.wall_x(20, -1, end);
  s.quad({2, -end, 0}, {2, -end, -end}, {2, end, -end}, {2, end, 0}, both_sides);
  const auto right = look_at(s).importance;
  EXPECT_GT(right[bake::toward_right], 2 * right[bake::toward_left]);
  EXPECT_GT(right[bake::toward_right], right[bake::toward_up]);
  EXPECT_GT(right[bake::toward_right], right[bake::toward_down]);

  // The same with the near wall below: the gap is above.
  tiny_scene t;
  t.wall_x(20, -1, end);
  t.quad({2, -end, -end}, {2, 0, -end}, {2, 0, end}, {2, -end, end}, both_sides);
  const auto up = look_at(t).importance;
  EXPECT_GT(up[bake::toward_up], 2 * up[bake::toward_down]);
  EXPECT_GT(up[bake::toward_up], up[bake::toward_right]);
}

TEST_P(source_view_test, importance_of_one_edge_is_what_the_formula_says) {
  // Depth 2 left of the middle of the front image, background (1, with a far plane of 100) right of it. The wall is
  // narrow enough for the front image alone: 16 columns and 16 rows of 64, from (16, 24) to (31, 39).
  tiny_scene s;
  s.quad({2, -0.5f, 0}, {2, -0.5f, -1}, {2, 0.5f, -1}, {2, 0.5f, 0}, both_sides);
  const auto i = look_at(s).importance;
  const double gap = (1.0 - 0.02) / 0.02;
  EXPECT_NEAR(i[bake::toward_right], 16 * gap * 31.5 / 64, 1e-3 * i[0]);
  EXPECT_NEAR(i[bake::toward_left], 16 * gap * (1 - 16.5 / 64), 1e-3 * i[2]);
  EXPECT_NEAR(i[bake::toward_up], 16 * gap * 39.5 / 64, 1e-3 * i[1]);
  EXPECT_NEAR(i[bake::toward_down], 16 * gap * (1 - 24.5 / 64), 1e-3 * i[3]);
}

TEST_P(source_view_test, the_noted_pixel_shows_the_polygon) {
  tiny_scene s = cloud();
  const scene::world_geometry world = scene::flatten(s.finished());
  const bake::ray_scene rays(world, false);
  const bake::pose turned = turned_along_x();
  bake::hemicube_view view;
  const auto drawn = source(world);
  drawn->render(turned, view);
  EXPECT_EQ(drawn->resolution(), size);
  ASSERT_GT(view.seen.size(), 50u);
  bake::sight seen;
  std::size_t same = 0;
  for (const bake::seen_polygon& p : view.seen) {
    rays.trace(turned.eye, bake::pixel_direction(turned, size, p.pixel), seen);
    same += seen.front == p.id ||
            std::any_of(seen.before.begin(), seen.before.end(), [&](const auto& b) { return b.polygon == p.id; });
  }
  // A pixel's center on an edge may be given to either side.
  EXPECT_GE(same + view.seen.size() / 200, view.seen.size());
}

void expect_same_seen(const bake::hemicube_view& a, const bake::hemicube_view& b) {
  ASSERT_EQ(a.seen.size(), b.seen.size());
  for (std::size_t i = 0; i < a.seen.size(); ++i) {
    ASSERT_EQ(a.seen[i].id, b.seen[i].id);
    ASSERT_EQ(a.seen[i].pixels, b.seen[i].pixels) << a.seen[i].id;
    ASSERT_EQ(a.seen[i].pixel, b.seen[i].pixel) << a.seen[i].id;
  }
}

std::vector<bake::pose> poses_around(std::size_t count) {
  std::vector<bake::pose> poses(count, turned_along_x());
  for (std::size_t i = 0; i < count; ++i)
    poses[i].eye = {0.01f * static_cast<float>(i), 0.1f * static_cast<float>(i), 0};
  return poses;
}

// Not even the last bit of a sum may depend on what was rendered before, together with it or on another thread.
TEST_P(source_view_test, a_pose_gives_the_same_view_alone_and_among_others) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto tested = source(world);
  const std::vector<bake::pose> poses = poses_around(9);
  std::vector<bake::hemicube_view> alone(poses.size());
  for (std::size_t i = poses.size(); i-- > 0;) tested->render(poses[i], alone[i]);
  EXPECT_GT(alone[0].seen.size(), 100u);
  const tbb::global_control threads_beyond_cores(tbb::global_control::max_allowed_parallelism, 8);
  for (const int threads : {1, 2, 8}) {
    std::vector<bake::hemicube_view> together(poses.size());
    tbb::task_arena(threads).execute([&] { tested->render(poses, together); });
    for (std::size_t i = 0; i < poses.size(); ++i) {
      expect_same_seen(alone[i], together[i]);
      EXPECT_EQ(alone[i].importance, together[i].importance) << threads << " threads, pose " << i;
    }
  }
}

// Glass once vanished from every view after an image.
TEST_P(source_view_test, an_image_between_two_views_changes_nothing) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto tested = source(world);
  bake::hemicube_view a, b;
  bake::hemicube_image image;
  tested->render(turned_along_x(), a);
  for (const bake::pose& from : poses_around(3)) tested->render_image(from, image);
  tested->render(turned_along_x(), b);
  EXPECT_GT(a.seen.size(), 100u);
  expect_same_seen(a, b);
  EXPECT_EQ(a.importance, b.importance);
}

TEST_P(source_view_test, telling_the_parts_of_its_cost_changes_nothing) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto tested = source(world);
  bake::hemicube_view a, b;
  tested->render(turned_along_x(), a);
  const auto split = tested->render_split(turned_along_x(), b);
  EXPECT_GT(a.seen.size(), 100u);
  expect_same_seen(a, b);
  EXPECT_EQ(a.importance, b.importance);
  EXPECT_TRUE(!split || split->draw > 0.0);
}

// A source with an OpenGL context is on a thread of its own, as in a bake.
std::unique_ptr<bake::hemicube_source> source_for_threads(const tested_source& which,
                                                          const scene::world_geometry& world) {
  if (!which.needs_device) return which.make(nullptr, world, source_test_size, 100.0f);
  const auto context = std::make_shared<std::unique_ptr<sightcell::picture::gl_context>>();
  return bake::make_source_on_thread([=, &world] {
    *context = std::make_unique<sightcell::picture::gl_context>();
    return which.make(context->get(), world, source_test_size, 100.0f);
  });
}

TEST_P(source_view_test, several_threads_get_what_one_gets) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto tested = source_for_threads(GetParam(), world);
  const std::vector<bake::pose> poses = poses_around(16);
  std::vector<bake::hemicube_view> one(poses.size()), many(poses.size());
  tested->render(poses, one);
  const tbb::global_control threads_beyond_cores(tbb::global_control::max_allowed_parallelism, 4);
  tbb::task_arena(4).execute([&] {
    tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) { tested->render(poses[i], many[i]); });
  });
  for (std::size_t i = 0; i < poses.size(); ++i) {
    expect_same_seen(one[i], many[i]);
    EXPECT_EQ(one[i].importance, many[i].importance) << i;
  }
}

// Glass is in the view and not in the image.
TEST_P(source_view_test, the_image_is_what_the_view_was_made_of) {
  tiny_scene s = cloud();
  const scene::world_geometry world = scene::flatten(s.finished());
  for (const std::uint32_t resolution : {16u, 50u, 64u}) {
    const auto tested = source(world, resolution);
    bake::hemicube_view view;
    bake::hemicube_image image;
    tested->render(turned_along_x(), view);
    tested->render_image(turned_along_x(), image);
    EXPECT_EQ(image.resolution, resolution);
    ASSERT_EQ(image.ids.size(), 3 * resolution * resolution);
    ASSERT_EQ(image.inverse_depths.size(), image.ids.size());
    std::map<std::uint32_t, bake::seen_polygon> expected;
    for (std::uint32_t i = 0; i < image.ids.size(); ++i) {
      EXPECT_EQ(image.ids[i] == scene::no_index, image.inverse_depths[i] == 0.0f) << i;
      if (image.ids[i] == scene::no_index) continue;
      ++expected.try_emplace(image.ids[i], bake::seen_polygon{image.ids[i], 0, i}).first->second.pixels;
    }
    std::size_t opaque = 0, glass = 0;
    for (const bake::seen_polygon& seen : view.seen) {
      if (!world.kinds[seen.id].occludes()) {
        ++glass;
        continue;
      }
      ++opaque;
      EXPECT_EQ(seen.pixels, expected[seen.id].pixels) << seen.id;
      EXPECT_EQ(seen.pixel, expected[seen.id].pixel) << seen.id;
    }
    EXPECT_EQ(opaque, expected.size());
    EXPECT_GT(glass, 0u);
  }
}

// A closed room: the depth of every pixel is that of the wall along its face's axis.
TEST_P(source_view_test, depths_of_the_image_are_along_the_axes_of_the_faces) {
  tiny_scene s;
  s.closed_box({-4, -4, -4}, {4, 4, 4}, true);
  const scene::world_geometry world = scene::flatten(s.finished());
  bake::pose from = along_x;
  from.eye = {2, 1, -1};  // 2 m before the front wall, 5 and 3 beside, 3 and 5 above and below
  bake::hemicube_image image;
  source(world)->render_image(from, image);
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return 1.0f / image.inverse_depths[y * 3 * size + x]; };
  EXPECT_NEAR(at(size / 2, size / 2), 2.0f, 1e-4f);
  EXPECT_NEAR(at(0, 0), 2.0f, 1e-4f);
  EXPECT_NEAR(at(size, size / 2), 3.0f, 1e-4f) << "left, toward -z";
  EXPECT_NEAR(at(2 * size - 1, size / 2), 5.0f, 1e-4f) << "right, toward +z";
  EXPECT_NEAR(at(2 * size + size / 2, size - 1), 3.0f, 1e-4f) << "up";
  EXPECT_NEAR(at(2 * size + size / 2, 0), 5.0f, 1e-4f) << "down";
}

// Culling by clusters must not lose what an image of everything shows: turned frames see the same directions.
TEST_P(source_view_test, a_full_turn_sees_as_much_from_any_start) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto tested = source(world, 256);
  const auto all_around = [&](const bake::pose& from) {
    std::vector<std::uint32_t> pixels(world.kinds.size(), 0);
    bake::hemicube_view view;
    for (const float side : {1.0f, -1.0f}) {
      bake::pose p = from;
      p.forward *= side;
      p.right *= side;
      tested->render(p, view);
      for (const bake::seen_polygon& seen : view.seen) pixels[seen.id] += seen.pixels;
    }
    return pixels;
  };
  bake::pose turned;
  turned.forward = {0, 1, 0};
  turned.up = {0, 0, -1};
  turned.right = glm::cross(turned.forward, turned.up);
  const auto a = all_around(along_x), b = all_around(turned);
  // The faces of both cubes are the same six squares: the same pixels in another order.
  std::size_t different = 0;
  for (std::size_t id = 0; id < a.size(); ++id) different += (a[id] > 8) != (b[id] > 8) ? 1u : 0u;
  EXPECT_LE(different, a.size() / 100);
}

// Two gathers of one image.
class gather_test : public source_test {
 protected:
  static std::unique_ptr<bake::hemicube_source> source_of(const char* name, const scene::world_geometry& world,
                                                          std::uint32_t resolution) {
    return source(source_called(name), world, resolution, 30.0f);
  }
};

TEST_P(gather_test, both_give_the_same_view) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  for (const std::uint32_t resolution : {16u, 50u, 128u}) {  // 50: faces that are no multiple of a work group
    const auto read_back = source_of("read_back", world, resolution);
    const auto compute = source(world, resolution, 30.0f);
    bake::hemicube_view a, b;
    for (int k = 0; k < 3; ++k) {
      bake::pose from = along_x;
      from.eye.z = 0.2f * static_cast<float>(k);
      read_back->render(from, a);
      compute->render(from, b);
      EXPECT_GT(a.seen.size(), 100u);
      ASSERT_EQ(a.seen.size(), b.seen.size());
      for (std::size_t i = 0; i < a.seen.size(); ++i) {
        ASSERT_EQ(a.seen[i].id, b.seen[i].id);
        ASSERT_EQ(a.seen[i].pixels, b.seen[i].pixels);
      }
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(b.importance[i], a.importance[i], 1e-4 * a.importance[i]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(of, gather_test, ::testing::Values(source_called("compute")),
                         [](const auto& tested) { return tested.param.name; });

// Pixels with an edge through their center may go to either side, no others; importance follows.
TEST_P(source_view_test, rays_see_the_same) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto rays = source(source_called("rays"), world, 256, 30.0f);
  const auto tested = source(world, 256, 30.0f);
  for (const bake::pose& from : poses_around(3)) {
    bake::hemicube_view a, b;
    rays->render(from, a);
    tested->render(from, b);
    EXPECT_GT(a.seen.size(), 300u);
    std::map<std::uint32_t, std::int64_t> more;
    for (const bake::seen_polygon& seen : a.seen) more[seen.id] += seen.pixels;
    for (const bake::seen_polygon& seen : b.seen) more[seen.id] -= seen.pixels;
    std::int64_t different = 0;
    for (const auto& [id, pixels] : more) different += std::abs(pixels);
    EXPECT_LE(different, 2 * 3 * 256 * 256 / 1000) << "one pixel of a thousand: many edges, few pixels";
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(b.importance[i], a.importance[i], 1e-3 * a.importance[i]);
  }
}

TEST_P(source_view_test, wrong_options_are_refused) {
  tiny_scene s;
  s.wall_x(2, -1, 1);
  const scene::world_geometry world = scene::flatten(s.finished());
  for (const std::uint32_t resolution : {0u, 15u, 17u, 4098u})
    EXPECT_EQ(error_id([&] { source(world, resolution); }), "hemicube.resolution") << resolution;
  for (const float far_plane : {0.0f, -1.0f, std::nanf(""), INFINITY})
    EXPECT_EQ(error_id([&] { source(world, size, far_plane); }), "hemicube.far-plane") << far_plane;
  const auto tested = source(world, 32);
  EXPECT_EQ(tested->resolution(), 32u);
  EXPECT_FALSE(tested->device().empty());
}

TEST_P(gather_test, too_many_polygons_for_the_device_are_refused) {
  source_of("compute", scene::flatten(cloud().finished()), 16);  // makes the context current
  EXPECT_EQ(error_id([] { bake::polygon_counts(0xFFFFFFFEu, 0); }), "gpu.scene-too-large");
}

SIGHTCELL_TEST_ALL_SOURCES(source_view_test);

// What ray_scene says of one ray after the other.
TEST(rays_source_test, sees_what_single_rays_see) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const bake::ray_scene rays(world, false);
  const auto shared = bake::make_rays_source(rays, {.resolution = 50, .far_plane = 30.0f});
  const bake::pose from = turned_along_x();
  bake::hemicube_view view;
  bake::hemicube_image image;
  shared->render(from, view);
  shared->render_image(from, image);
  std::map<std::uint32_t, std::uint32_t> passed;
  bake::sight seen;
  std::size_t different = 0;
  for (std::uint32_t pixel = 0; pixel < image.ids.size(); ++pixel) {
    rays.trace(from.eye, bake::pixel_direction(from, 50, pixel), seen);
    different += seen.front != image.ids[pixel];
    for (const bake::passed_polygon& p : seen.before) ++passed[p.polygon];
  }
  EXPECT_LE(different, 2u) << "directions are rounded in another way";
  std::size_t glass = 0;
  for (const bake::seen_polygon& p : view.seen) {
    if (world.kinds[p.id].occludes()) continue;
    ++glass;
    EXPECT_NEAR(p.pixels, passed[p.id], 1) << p.id;
  }
  EXPECT_GT(glass, 20u);
}

// Samplers that do not use the importance do not pay for it, and see the same.
TEST(chosen_source, sums_importance_for_samplers_that_use_it) {
  tiny_scene s;
  s.wall_x(2, -1, 0.5f);
  s.wall_x(5, -1, 20);
  const scene::world_geometry world = scene::flatten(s.finished());
  const bake::ray_scene rays(world, false);
  for (const char* name : {"cpu", "rays"}) {
    bake::hemicube_view views[2];
    for (const bool uses : {false, true}) {
      bake::settings how;
      how.source = name;
      how.sampler = uses ? "importance-depth" : "guided";
      how.resolution = size;
      bake::choose_source(how, world, rays).source->render(along_x, views[uses]);
      const auto sum = std::accumulate(views[uses].importance.begin(), views[uses].importance.end(), 0.0);
      EXPECT_EQ(sum > 0.0, uses) << name << ", " << how.sampler;
    }
    ASSERT_GE(views[0].seen.size(), 2u);
    EXPECT_TRUE(std::ranges::equal(views[0].seen, views[1].seen, [](const auto& a, const auto& b) {
      return a.id == b.id && a.pixels == b.pixels && a.pixel == b.pixel;
    }));
  }
}

TEST(rays_source_test, of_exact_duplicates_the_lowest_id_is_seen) {
  tiny_scene s;
  s.wall_x(5, -1, 20);
  const auto first = s.wall_x(2, -1, 1);
  for (int i = 0; i < 4; ++i) s.wall_x(2, -1, 1);
  const auto leaf = [&] {
    return s.masked_quad({1, -0.2f, -0.2f}, {1, -0.2f, 0.2f}, {1, 0.2f, 0.2f}, {1, 0.2f, -0.2f}, {2, 1, {255, 0}},
                         true);
  };
  const auto first_leaf = leaf();
  leaf();
  leaf();
  const scene::world_geometry world = scene::flatten(s.finished());
  bake::hemicube_view view;
  bake::make_rays_source(world, {size, 30.0f})->render(along_x, view);
  EXPECT_EQ(view.seen.size(), 6u);
  EXPECT_TRUE(sees_wall(view, first));
  EXPECT_TRUE(sees_wall(view, first_leaf));
}

// Rule 2: within 0.2 mm along the ray, so that rays which lean reach less deep.
TEST(rays_source_test, panes_behind_a_wall_are_seen_as_far_as_places_are_the_same) {
  for (const float behind : {0.00014f, 0.00018f, 0.00022f}) {
    tiny_scene s;
    const auto wall = s.wall_x(2, -1, 1);
    const auto glass = s.wall_x(2 + behind, -1, 1, pane);
    const scene::world_geometry world = scene::flatten(s.finished());
    bake::pose from = along_x;
    from.eye.y = 0.001f;  // a ray through the edge between two panes meets both
    bake::hemicube_view view;
    bake::make_rays_source(world, {size, 30.0f})->render(from, view);
    const std::uint32_t all = pixels_of(view, wall) + pixels_of(view, wall + 1);
    const std::uint32_t seen = pixels_of(view, glass) + pixels_of(view, glass + 1);
    EXPECT_EQ(all, 32u * 32u);
    if (behind < 0.00015f) {
      EXPECT_EQ(seen, all);
    } else if (behind > 0.0002f) {
      EXPECT_EQ(seen, 0u);
    } else {
      EXPECT_GT(seen, all / 4);
      EXPECT_LT(seen, all - all / 4);
    }
  }
}

TEST(rays_source_test, all_double_sided_is_the_ray_scenes_to_say) {
  tiny_scene s;
  const auto wall = s.wall_x(2, 1, 1);
  const scene::world_geometry world = scene::flatten(s.finished());
  for (const bool all_double_sided : {false, true}) {
    const bake::ray_scene rays(world, all_double_sided);
    bake::hemicube_view view;
    bake::make_rays_source(rays, {size, 30.0f})->render(along_x, view);
    EXPECT_EQ(sees_wall(view, wall), all_double_sided);
  }
}

}  // namespace
