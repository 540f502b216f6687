// What only the rasteriser promises: the same bits on every instruction set and any number of threads. What it sees is
// tested with all sources in source_test.cpp.
#include "source/cpu_source.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "sightcell/scene/error.h"
#include "source/hemicube_faces.h"
#include "tiny_scene.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::tiny_scene;

// Triangles of all sizes and kinds around the origin: slivers, specks, some that reach behind the eye and across
// everything, some edge to edge.
scene::world_geometry rubble() {
  std::mt19937 engine(11);
  const auto number = [&] { return 2.0f * (static_cast<float>(engine() >> 8) / 16777216.0f) - 1.0f; };
  tiny_scene s;
  for (int i = 0; i < 5000; ++i) {
    const float size = std::pow(10.0f, 1.5f * number() - 1.0f);
    const glm::vec3 center = 20.0f * glm::vec3(number(), number(), number());
    if (glm::length(center) < 2.0f) continue;
    const auto corner = [&] { return center + size * glm::vec3(number(), number(), number()); };
    const glm::vec3 a = corner(), b = corner(), c = i % 5 == 0 ? 0.999f * b + 0.001f * corner() : corner();
    s.triangle(a, b, c, {i % 7 == 0 ? scene::alpha_mode::blend : scene::alpha_mode::opaque, i % 3 == 0});
  }
  for (int i = 0; i < 8; ++i) {
    const auto corner = [&] { return glm::vec3(90.0f * number(), -4.0f + 3.0f * number(), 90.0f * number()); };
    s.triangle(corner(), corner(), corner(), {scene::alpha_mode::opaque, true});
  }
  for (int i = 0; i < 30; ++i) {
    const float x = 0.5f * static_cast<float>(i) - 8.0f;
    s.quad({x, -3, -9}, {x + 0.5f, -3, -9}, {x + 0.5f, -2, -9}, {x, -2, -9}, {scene::alpha_mode::opaque, false});
  }
  return scene::flatten(s.finished());
}

std::vector<bake::pose> poses() {
  std::vector<bake::pose> made;
  for (int i = 0; i < 6; ++i) {
    bake::pose p;
    const float angle = 1.1f * static_cast<float>(i);
    p.eye = {0.1f * static_cast<float>(i), 0.3f, -0.2f};
    p.forward = glm::normalize(glm::vec3(std::cos(angle), 0.2f * static_cast<float>(i % 3 - 1), std::sin(angle)));
    p.right = glm::normalize(glm::cross(p.forward, glm::vec3(0.1f, 1, 0)));
    p.up = glm::cross(p.right, p.forward);
    made.push_back(p);
  }
  return made;
}

void expect_same(const bake::hemicube_view& a, const bake::hemicube_view& b) {
  ASSERT_EQ(a.seen.size(), b.seen.size());
  for (std::size_t i = 0; i < a.seen.size(); ++i) {
    ASSERT_EQ(a.seen[i].id, b.seen[i].id);
    ASSERT_EQ(a.seen[i].pixels, b.seen[i].pixels);
    ASSERT_EQ(a.seen[i].pixel, b.seen[i].pixel);
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(a.importance[i], b.importance[i]);
}

TEST(cpu_source, every_instruction_set_gives_the_same_bits) {
  const scene::world_geometry world = rubble();
  for (const std::uint32_t resolution : {16u, 50u, 202u}) {
    const auto best = bake::make_cpu_source(world, {resolution, 70.0f});
    const auto portable = bake::make_cpu_source(world, {resolution, 70.0f, bake::cpu_instructions::portable});
    if (best->device() == portable->device()) GTEST_SKIP() << "this processor has the portable kernel alone";
    for (const bake::pose& where : poses()) {
      bake::hemicube_view a, b;
      best->render(where, a);
      portable->render(where, b);
      EXPECT_GT(a.seen.size(), resolution);
      expect_same(a, b);
      bake::hemicube_image c, d;
      best->render_image(where, c);
      portable->render_image(where, d);
      EXPECT_EQ(c.ids, d.ids);
      EXPECT_EQ(c.inverse_depths, d.inverse_depths);
    }
  }
}

TEST(cpu_source, the_same_on_any_number_of_threads) {
  const scene::world_geometry world = rubble();
  const auto source = bake::make_cpu_source(world, {64, 70.0f});
  std::vector<bake::pose> many;
  for (int i = 0; i < 8; ++i)
    for (const bake::pose& p : poses()) many.push_back(p);
  std::vector<bake::hemicube_view> alone(many.size());
  for (std::size_t i = 0; i < many.size(); ++i) source->render(many[i], alone[i]);
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  for (const int threads : {1, 2, 8}) {
    std::vector<bake::hemicube_view> views(many.size());
    tbb::task_arena arena(threads);
    arena.execute([&] { source->render(many, views); });
    for (std::size_t i = 0; i < many.size(); ++i) expect_same(alone[i], views[i]);
  }
}

TEST(cpu_source, the_split_answers_the_same) {
  const scene::world_geometry world = rubble();
  const auto source = bake::make_cpu_source(world, {64, 70.0f});
  bake::hemicube_view a, b;
  source->render(poses()[1], a);
  const auto split = source->render_split(poses()[1], b);
  expect_same(a, b);
  ASSERT_TRUE(split.has_value());
  EXPECT_GT(split->draw, 0.0);
}

TEST(cpu_source, wrong_options_are_refused) {
  const scene::world_geometry world = rubble();
  const auto error_id = [&](std::uint32_t resolution, float far_plane) -> std::string {
    try {
      bake::make_cpu_source(world, {resolution, far_plane});
    } catch (const sightcell::error& e) {
      return e.id();
    }
    return "none";
  };
  for (const std::uint32_t resolution : {0u, 15u, 17u, 4098u})
    EXPECT_EQ(error_id(resolution, 1), "hemicube.resolution");
  for (const float far_plane : {0.0f, -1.0f, std::nanf(""), HUGE_VALF})
    EXPECT_EQ(error_id(64, far_plane), "hemicube.far-plane");
  EXPECT_EQ(error_id(64, 10.0f), "none");
}

TEST(cpu_source, a_scene_of_nothing_shows_nothing) {
  const scene::world_geometry world;
  bake::hemicube_view view;
  bake::make_cpu_source(world, {64, 10.0f})->render(bake::pose{}, view);
  EXPECT_TRUE(view.seen.empty());
  for (const double i : view.importance) EXPECT_EQ(i, 0.0);
}

}  // namespace
