#include "sightcell/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "sightcell/base/error.h"

namespace sightcell::scene {
namespace {

geometry triangles(std::size_t count) {
  geometry g;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    g.positions.insert(g.positions.end(), {glm::vec3(x, 0, 0), glm::vec3(x + 1, 0, 0), glm::vec3(x, 1, 0)});
    for (std::uint32_t k = 0; k < 3; ++k) g.indices.push_back(static_cast<std::uint32_t>(3 * i) + k);
  }
  return g;
}

draw draw_with(std::uint32_t geometry, const glm::dmat4& to_world = glm::dmat4(1.0)) {
  draw d;
  d.geometry = geometry;
  d.to_world = to_world;
  return d;
}

// Three draws of 2, 0 and 3 polygons.
scene sample() {
  scene s;
  s.name = "sample";
  s.materials.resize(2);
  s.geometries = {triangles(2), geometry{}, triangles(3)};
  s.draws = {draw_with(0), draw_with(1), draw_with(2, glm::translate(glm::dmat4(1.0), {10.0, 0.0, 0.0}))};
  finish(s);
  return s;
}

std::string id_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const error& e) {
    EXPECT_EQ(e.kind(), error_kind::bad_input);
    return e.id();
  }
  return "none";
}

TEST(scene, finish_numbers_draws_in_order) {
  const scene s = sample();
  EXPECT_EQ(s.polygon_count, 5u);
  EXPECT_EQ(s.draws[0].first_source, 0u);
  EXPECT_EQ(s.draws[1].first_source, 2u);
  EXPECT_EQ(s.draws[1].polygon_count, 0u);
  EXPECT_EQ(s.draws[2].first_source, 2u);
  EXPECT_EQ(s.draws[2].base_vertex, 6u);
}

TEST(scene, draw_of_skips_empty_draws) {
  const scene s = sample();
  EXPECT_EQ(draw_of(s, 0), 0u);
  EXPECT_EQ(draw_of(s, 1), 0u);
  EXPECT_EQ(draw_of(s, 2), 2u);
  EXPECT_EQ(draw_of(s, 4), 2u);
}

TEST(scene, finish_refuses_indices_that_are_not_there) {
  scene vertex = sample();
  vertex.geometries[0].indices[0] = 6;
  EXPECT_EQ(id_of([&] { finish(vertex); }), "scene.index-out-of-range");
  scene material = sample();
  material.draws[0].material = 2;
  EXPECT_EQ(id_of([&] { finish(material); }), "scene.index-out-of-range");
  scene geometry_index = sample();
  geometry_index.draws[0].geometry = 3;
  EXPECT_EQ(id_of([&] { finish(geometry_index); }), "scene.index-out-of-range");
  scene image_index = sample();
  image_index.materials[0].base_color_image = 0;
  EXPECT_EQ(id_of([&] { finish(image_index); }), "scene.index-out-of-range");
  scene half_triangle = sample();
  half_triangle.geometries[0].indices.pop_back();
  EXPECT_EQ(id_of([&] { finish(half_triangle); }), "scene.bad-field");
}

TEST(scene, finish_refuses_more_polygons_than_ids) {
  scene s;
  s.geometries = {geometry{}};
  s.geometries[0].positions.resize(1);
  s.geometries[0].indices.resize(3 * 65536);
  s.draws.assign(65536, draw_with(0));
  EXPECT_EQ(id_of([&] { finish(s); }), "scene.too-large");
}

TEST(scene, flatten_places_vertices_and_turns_mirrored_polygons) {
  scene s;
  s.geometries = {triangles(1)};
  s.draws = {draw_with(0, glm::translate(glm::dmat4(1.0), {5.0, 0.0, 0.0})),
             draw_with(0, glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0}))};
  finish(s);
  const world_geometry w = flatten(s);
  EXPECT_EQ(w.positions[0], glm::vec3(5, 0, 0));
  EXPECT_EQ(w.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 5, 4}));
  // Both face +z: mirrored in x, the second would face away without the swap.
  for (std::size_t i = 0; i < 2; ++i) {
    const glm::vec3 a = w.positions[w.indices[3 * i]];
    const glm::vec3 n = glm::cross(w.positions[w.indices[3 * i + 1]] - a, w.positions[w.indices[3 * i + 2]] - a);
    EXPECT_GT(n.z, 0.0f);
  }
  EXPECT_EQ(w.min, glm::vec3(-1, 0, 0));
  EXPECT_EQ(w.max, glm::vec3(6, 1, 0));
}

TEST(scene, polygons_without_area_or_finite_corners_are_absent_and_out_of_the_bounds) {
  scene s;
  s.geometries = {triangles(3)};
  s.geometries[0].positions[5] = {100, 0, 0};  // on the line of its other corners
  s.geometries[0].positions[6] = {0, std::numeric_limits<float>::quiet_NaN(), 0};
  s.draws = {draw_with(0)};
  finish(s);
  const world_geometry w = flatten(s);
  EXPECT_FALSE(w.kinds[0].absent);
  EXPECT_TRUE(w.kinds[1].absent);
  EXPECT_TRUE(w.kinds[2].absent);
  EXPECT_EQ(w.absent.no_area, 1u);
  EXPECT_EQ(w.absent.not_finite, 1u);
  EXPECT_EQ(w.warnings.size(), 1u) << "said once";
  EXPECT_EQ(w.max, glm::vec3(1, 1, 0));
  for (const glm::vec3& p : w.positions) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

TEST(scene, kinds_come_from_materials) {
  scene s = sample();
  s.materials[1].alpha = alpha_mode::mask;
  s.materials[1].double_sided = true;
  s.draws[2].material = 1;
  const world_geometry w = flatten(s);
  EXPECT_EQ(w.kinds[0].alpha, alpha_mode::opaque);
  EXPECT_FALSE(w.kinds[0].double_sided);
  EXPECT_EQ(w.kinds[2].alpha, alpha_mode::mask);
  EXPECT_TRUE(w.kinds[2].double_sided);
}

TEST(scene, tags_decide_what_hides_and_what_is_left_out) {
  const auto kind_with = [](const std::function<void(draw&)>& mark, animated_as animated = animated_as::always,
                            const std::vector<std::string>& closed = {}) {
    scene s;
    s.geometries = {triangles(1)};
    s.groups = {"door"};
    s.draws = {draw_with(0)};
    mark(s.draws[0]);
    finish(s);
    return flatten(s, animated, closed).kinds[0];
  };
  const polygon_kind plain = kind_with([](draw&) {});
  EXPECT_TRUE(plain.occludes() && !plain.always);
  const polygon_kind open = kind_with([](draw& d) { d.tags.occluder = false; });
  EXPECT_TRUE(!open.occludes() && !open.absent && !open.always);
  const polygon_kind door = kind_with([](draw& d) { d.tags.group = 0; });
  EXPECT_TRUE(!door.occludes() && !door.absent && !door.always);
  const std::vector<std::string> closed{"gate", "door"};
  EXPECT_TRUE(kind_with([](draw& d) { d.tags.group = 0; }, animated_as::always, closed).occludes());
  EXPECT_FALSE(
      kind_with([](draw& d) { d.tags.group = 0, d.tags.occluder = false; }, animated_as::always, closed).occludes());
  const polygon_kind sky = kind_with([](draw& d) { d.tags.always = true; });
  EXPECT_TRUE(sky.occludes() && sky.always);
  const auto left_out = [](const polygon_kind& k) { return k.absent && !k.occludes() && !k.always; };
  EXPECT_TRUE(left_out(kind_with([](draw& d) { d.tags.dynamic = true; })));
  EXPECT_TRUE(left_out(kind_with([](draw& d) { d.tags.never = d.tags.always = true; }))) << "never wins";
  EXPECT_TRUE(left_out(kind_with([](draw& d) { d.lod_object = 0, d.lod_level = 1; })));

  const auto moving = [](draw& d) { d.tags.animated = true; };
  const polygon_kind moves = kind_with(moving);
  EXPECT_TRUE(!moves.occludes() && !moves.absent && moves.always);
  const polygon_kind rests = kind_with(moving, animated_as::rest);
  EXPECT_TRUE(rests.occludes() && !rests.always);
  EXPECT_TRUE(left_out(kind_with(moving, animated_as::dynamic)));
}

TEST(scene, coarser_levels_follow_the_finest) {
  scene s;
  s.geometries = {triangles(2)};
  s.draws = {draw_with(0), draw_with(0), draw_with(0), draw_with(0)};
  s.draws[1].lod_object = s.draws[2].lod_object = s.draws[3].lod_object = 5;
  s.draws[2].lod_level = 1;
  s.draws[3].lod_level = 2;
  s.draws[3].tags.never = true;
  finish(s);
  const world_geometry w = flatten(s);
  ASSERT_EQ(w.lods.size(), 1u);
  ASSERT_EQ(w.lods[0].finest.size(), 1u);
  EXPECT_EQ(w.lods[0].finest[0].first, 2u);
  ASSERT_EQ(w.lods[0].coarser.size(), 1u) << "never is in no set";
  EXPECT_EQ(w.lods[0].coarser[0].first, 4u);
  EXPECT_EQ(w.lods[0].coarser[0].count, 2u);
  EXPECT_EQ(w.absent.coarser_level, 4u);
}

TEST(scene, fingerprint_follows_what_decides_visibility_and_nothing_else) {
  const scene s = sample();
  const auto print_after = [&s](const std::function<void(scene&)>& change) {
    scene changed = s;
    change(changed);
    finish(changed);
    return changed.fingerprint;
  };
  EXPECT_EQ(print_after([](scene&) {}), s.fingerprint);
  EXPECT_EQ(print_after([](scene& c) { c.name = "other"; }), s.fingerprint);
  EXPECT_EQ(print_after([](scene& c) { c.materials[0].name = "other"; }), s.fingerprint);
  EXPECT_EQ(print_after([](scene& c) { c.materials[0].base_color.r = 0; }), s.fingerprint);
  EXPECT_EQ(print_after([](scene& c) { c.draws[0].host_tag = 7; }), s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { c.geometries[0].positions[0].x = 0.5f; }), s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { std::swap(c.geometries[0].indices[0], c.geometries[0].indices[1]); }),
            s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { c.draws[0].to_world[3][0] = 1; }), s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { c.materials[0].alpha = alpha_mode::mask; }), s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { c.materials[0].double_sided = true; }), s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { c.draws[0].tags.always = true; }), s.fingerprint);
  EXPECT_NE(print_after([](scene& c) { c.draws[0].lod_object = 0; }), s.fingerprint);
}

TEST(scene, an_empty_scene_is_fine) {
  scene s;
  finish(s);
  const world_geometry w = flatten(s);
  EXPECT_TRUE(w.indices.empty());
  EXPECT_EQ(w.min, glm::vec3(0));
}

}  // namespace
}  // namespace sightcell::scene
