// What only the rasterizer guarantees: the same bits with every instruction set and any number of threads. What it sees
// is tested with all sources in source_view_test.cpp and source_mask_test.cpp.
#include "hemicube/cpu/cpu_source.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "hemicube/hemicube_faces.h"
#include "sightcell/base/error.h"
#include "unit/bake/hemicube/cpu/rubble.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::rubble;
using sightcell::test::rubble_poses;

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
  const auto sets = bake::available_instructions();
  ASSERT_EQ(sets.back(), bake::cpu_instructions::portable);
  if (sets.size() == 1) GTEST_SKIP() << "this processor has the portable kernel alone";
  const scene::world_geometry world = rubble();
  for (const std::uint32_t resolution : {16u, 50u, 202u}) {
    const auto portable = bake::make_cpu_source(world, {resolution, 70.0f, bake::cpu_instructions::portable});
    for (const bake::cpu_instructions set : sets) {
      if (set == bake::cpu_instructions::portable) continue;
      const auto tested = bake::make_cpu_source(world, {resolution, 70.0f, set});
      SCOPED_TRACE(tested->device());
      ASSERT_NE(tested->device(), portable->device());
      for (const bake::pose& where : rubble_poses()) {
        bake::hemicube_view a, b;
        tested->render(where, a);
        portable->render(where, b);
        EXPECT_GT(a.seen.size(), resolution);
        expect_same(a, b);
        bake::hemicube_image c, d;
        tested->render_image(where, c);
        portable->render_image(where, d);
        EXPECT_EQ(c.ids, d.ids);
        EXPECT_EQ(c.inverse_depths, d.inverse_depths);
      }
    }
  }
}

// Thin stripes in the direction of the diagonal of opacity maps, on triangles of all sizes.
scene::world_geometry leaves() {
  scene::world_geometry world = rubble();
  for (scene::alpha_mask& mask : world.masks) {
    mask.width = mask.height = 64;
    mask.texels.clear();
    for (std::uint32_t y = 0; y < mask.height; ++y)
      for (std::uint32_t x = 0; x < mask.width; ++x)
        mask.texels.push_back((x + y) % 32 > 3 ? 0 : static_cast<std::uint8_t>(100 + (x * 7 + y) % 156));
  }
  for (scene::masked_polygon& p : world.masked) {
    p.alphas = {1.0f, 1.0f, 1.0f};
    p.uvs = {glm::vec2{0.0f, 0.0f}, glm::vec2{1.0f, 0.0f}, glm::vec2{0.0f, 1.0f}};
  }
  return world;
}

TEST(cpu_source, opacity_maps_change_no_bit) {
  scene::world_geometry world = leaves();
  const auto plain = bake::make_cpu_source(world, {602, 70.0f});
  world.opacity = scene::make_opacity_maps(world.masked, world.masks);
  for (const bake::cpu_instructions set : bake::available_instructions()) {
    const auto tested = bake::make_cpu_source(world, {602, 70.0f, set});
    SCOPED_TRACE(tested->device());
    std::size_t masked = 0;
    for (const bake::pose& where : rubble_poses()) {
      bake::hemicube_view a, b;
      tested->render(where, a);
      plain->render(where, b);
      expect_same(a, b);
      for (const bake::seen_polygon& seen : a.seen) masked += world.kinds[seen.id].alpha_tested ? 1u : 0u;
    }
    EXPECT_GT(masked, 100u);
  }
}

TEST(cpu_source, the_same_on_any_number_of_threads) {
  const scene::world_geometry world = rubble();
  const auto source = bake::make_cpu_source(world, {64, 70.0f});
  std::vector<bake::pose> many;
  for (int i = 0; i < 8; ++i)
    for (const bake::pose& p : rubble_poses()) many.push_back(p);
  std::vector<bake::hemicube_view> alone(many.size());
  for (std::size_t i = 0; i < many.size(); ++i) source->render(many[i], alone[i]);
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  for (const int threads : {1, 2, 8}) {
    std::vector<bake::hemicube_view> views(many.size());
    tbb::task_arena arena(threads);
    arena.execute([&] { source->render(many, views); });
    for (std::size_t i = 0; i < many.size(); ++i) expect_same(alone[i], views[i]);
    const auto later = bake::make_cpu_source(world, {.resolution = 64, .far_plane = 70.0f, .when_needed = true});
    std::vector<bake::hemicube_view> of_later(many.size());
    arena.execute([&] { later->render(many, of_later); });
    for (std::size_t i = 0; i < many.size(); ++i) expect_same(alone[i], of_later[i]);
  }
}

TEST(cpu_source, the_split_answers_the_same) {
  const scene::world_geometry world = rubble();
  const auto source = bake::make_cpu_source(world, {64, 70.0f});
  bake::hemicube_view a, b;
  source->render(rubble_poses()[1], a);
  const auto split = source->render_split(rubble_poses()[1], b);
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
