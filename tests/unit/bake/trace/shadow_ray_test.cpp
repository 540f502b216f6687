#include "trace/shadow_ray.h"

#include <gtest/gtest.h>

#include <functional>
#include <glm/geometric.hpp>
#include <set>

#include "sightcell/base/random.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::scene_with_rays;
using test::tiny_scene;
using ids = std::vector<std::uint32_t>;

constexpr glm::vec3 up{0.0f, 1.0f, 0.0f};

// A triangle of 2 m around the y axis. Its front is up or down.
std::uint32_t roof(tiny_scene& tiny, float height, bool front_up, tiny_scene::look how = {}) {
  const glm::vec3 a{-2, height, 2}, b{2, height, 2}, c{0, height, -3};
  return front_up ? tiny.triangle(a, b, c, how) : tiny.triangle(a, c, b, how);
}

lacking_casters lacking(const scene_with_rays& w, const std::set<std::uint32_t>& set, float bias = 1e-3f) {
  lacking_casters found;
  const bool any = find_lacking(
      w.rays, {glm::vec3{0.0f}, up, bias, 0}, [&](std::uint32_t p) { return set.count(p) > 0; }, found);
  EXPECT_EQ(any, !found.empty());
  return found;
}

// Polygon 0 is the ground, which receives the shadow.
tiny_scene ground() {
  tiny_scene tiny;
  roof(tiny, 0.0f, true);
  return tiny;
}

TEST(shadow_ray, needs_one_of_the_occluders_that_turn_a_drawn_side_to_the_light) {
  tiny_scene tiny = ground();
  const std::uint32_t high = roof(tiny, 2.0f, true), low = roof(tiny, 1.0f, true), away = roof(tiny, 0.5f, false);
  const scene_with_rays w(tiny);
  EXPECT_EQ(lacking(w, {}).one_of, (ids{low, high})) << "by their distance from the point";
  EXPECT_EQ(lacking(w, {away}).one_of, (ids{low, high})) << "a host that draws front faces alone needs one of these";
  EXPECT_TRUE(lacking(w, {low}).empty());
  EXPECT_TRUE(lacking(w, {high}).empty());
}

TEST(shadow_ray, needs_an_undrawn_side_where_there_is_nothing_else) {
  tiny_scene tiny = ground();
  const std::uint32_t low = roof(tiny, 1.0f, false), high = roof(tiny, 2.0f, false);
  const scene_with_rays w(tiny);
  EXPECT_EQ(lacking(w, {}).one_of, (ids{low, high})) << "a host that draws both sides has a shadow there";
  EXPECT_TRUE(lacking(w, {high}).empty());
}

TEST(shadow_ray, takes_both_sides_of_double_sided_materials) {
  tiny_scene tiny = ground();
  const std::uint32_t sheet = roof(tiny, 1.0f, false, {scene::alpha_mode::opaque, true});
  const std::uint32_t high = roof(tiny, 2.0f, true);
  const scene_with_rays w(tiny);
  EXPECT_EQ(lacking(w, {}).one_of, (ids{sheet, high}));
  EXPECT_TRUE(lacking(w, {sheet}).empty());
}

TEST(shadow_ray, passes_blend_the_receiver_and_what_is_nearer_than_the_bias) {
  tiny_scene tiny = ground();
  roof(tiny, 1.0f, true, {scene::alpha_mode::blend, false});
  roof(tiny, 0.01f, true);
  const scene_with_rays w(tiny);
  EXPECT_TRUE(lacking(w, {}, 0.02f).empty());
  EXPECT_EQ(lacking(w, {}, 0.001f).one_of, (ids{2}));
}

TEST(shadow_ray, tests_the_alpha_of_masks) {
  tiny_scene tiny = ground();
  // Left half 0, right half 255: x < 0 is cut away.
  scene::alpha_map half{2, 1, {0, 255}};
  const std::uint32_t leaf = tiny.masked_quad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, half, true);
  const scene_with_rays w(tiny);
  lacking_casters found;
  const auto none = [](std::uint32_t) { return false; };
  EXPECT_FALSE(find_lacking(w.rays, {{-0.9f, 0, 0.1f}, up, 1e-3f, 0}, none, found));
  ASSERT_TRUE(find_lacking(w.rays, {{0.9f, 0, 0.1f}, up, 1e-3f, 0}, none, found));
  ASSERT_EQ(found.one_of.size(), 1u);
  EXPECT_EQ(found.one_of.front() / 2, leaf / 2);
}

// A host may hide or move it, so it casts a shadow beside what occludes, and never instead of it.
TEST(shadow_ray, needs_each_non_occluder_where_no_occluder_blocks) {
  tiny_scene tiny = ground();
  const std::uint32_t door = roof(tiny, 1.0f, true), gate = roof(tiny, 2.0f, true);
  tiny.tag(door, {.occluder = false});
  tiny.tag(gate, {.occluder = false});
  const scene_with_rays alone(tiny);
  EXPECT_EQ(lacking(alone, {}).each, (ids{door, gate}));
  EXPECT_EQ(lacking(alone, {gate}).each, (ids{door}));
  EXPECT_TRUE(lacking(alone, {door, gate}).empty());
  const std::uint32_t wall = roof(tiny, 3.0f, true);
  const scene_with_rays behind(tiny);
  EXPECT_EQ(lacking(behind, {door, gate}).one_of, (ids{wall}));
  EXPECT_TRUE(lacking(behind, {door, gate}).each.empty());
  EXPECT_TRUE(lacking(behind, {wall}).empty());
}

// Packets against single rays: each kind of blocker at many points, with random sets.
TEST(shadow_ray, packets_suspect_where_a_single_ray_finds_something_lacking) {
  tiny_scene tiny = ground();
  random_stream random(7, 7, purpose::jitter);
  for (int i = 0; i < 24; ++i) {
    const glm::vec3 at = random.in_box({-2, 0.5f, -2}, {2, 4, 2});
    const tiny_scene::look how{i % 6 == 0 ? scene::alpha_mode::blend : scene::alpha_mode::opaque, i % 4 == 1};
    const glm::vec3 b = at + glm::vec3{1.5f, 0.2f, 0.0f}, c = at + glm::vec3{0.0f, 0.1f, -1.5f};
    const std::uint32_t polygon = i % 2 == 0 ? tiny.triangle(at, b, c, how) : tiny.triangle(at, c, b, how);
    if (i % 5 == 2) tiny.tag(polygon, {.occluder = false});
  }
  tiny.masked_quad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, {2, 1, {0, 255}}, true);
  const scene_with_rays w(tiny);
  std::vector<shadow_line> lines;
  for (int i = 0; i < 1601; ++i) {
    const glm::vec3 toward = glm::normalize(glm::vec3{0.3f * random.uniform(), 1.0f, 0.3f * random.uniform()});
    lines.push_back({random.in_box({-2, 0, -2}, {2, 2, 2}), toward, 1e-3f, static_cast<std::uint32_t>(i % 25)});
  }
  const std::vector<std::uint8_t> nowhere(lines.size(), 2);
  for (std::uint32_t modulus = 1; modulus < 6; ++modulus) {
    const auto contains = [&](std::uint32_t p) { return p % modulus != 0; };
    std::vector<std::uint8_t> suspect = nowhere;
    find_suspects(w.rays, lines, contains, suspect);
    std::size_t lacking_lines = 0, suspects = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      lacking_casters found;
      const bool lacks = find_lacking(w.rays, lines[i], contains, found);
      EXPECT_TRUE(!lacks || suspect[i] == 1) << i;
      EXPECT_LE(suspect[i], 1) << i;
      lacking_lines += lacks ? 1 : 0, suspects += suspect[i];
    }
    EXPECT_GT(lacking_lines, 60u);
    // The others have an undrawn side of the set in place of one that the set lacks.
    EXPECT_LE(suspects, 2 * lacking_lines);
  }
}

}  // namespace
}  // namespace sightcell::bake
