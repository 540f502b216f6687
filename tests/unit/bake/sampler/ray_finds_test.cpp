#include "sampler/ray_finds.h"

#include <gtest/gtest.h>

#include <vector>

#include "trace/ray_scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

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

}  // namespace
}  // namespace sightcell::bake
