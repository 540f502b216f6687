#include "trace/coincident.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

struct partners {
  scene::scene s;
  scene::world_geometry geometry;
  ray_scene rays;
  coincident_partners found;
  explicit partners(tiny_scene tiny, bool all_double_sided = false)
      : s(tiny.finished()), geometry(scene::flatten(s)), rays(geometry, all_double_sided), found(rays) {}
  bool are(std::uint32_t a, std::uint32_t b) const {
    const auto of_a = found.of(a), of_b = found.of(b);
    const bool there = std::binary_search(of_a.begin(), of_a.end(), b);
    EXPECT_EQ(there, std::binary_search(of_b.begin(), of_b.end(), a)) << "both or none";
    return there;
  }
};

TEST(coincident_partners, a_small_decal_and_its_large_wall_find_each_other) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(2, -1, 50);
  const auto decal = tiny.triangle({2, 3, 7}, {2, 3, 7.1f}, {2, 3.1f, 7});  // in the wall's upper triangle
  const auto apart = tiny.wall_x(2.1f, -1, 50);
  const partners p(tiny);
  EXPECT_TRUE(p.are(decal, wall) || p.are(decal, wall + 1));
  EXPECT_FALSE(p.are(decal, apart) || p.are(decal, apart + 1));
  EXPECT_FALSE(p.are(wall, wall + 1)) << "they share an edge and nothing else";
  EXPECT_EQ(p.found.polygon_count(), 2u);
}

TEST(coincident_partners, only_what_one_eye_can_see) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(2, -1, 1), back = tiny.wall_x(2, 1, 1);
  const auto sheet = tiny.wall_x(2.0005f, 1, 1, {scene::alpha_mode::blend, true});
  const auto gone = tiny.wall_x(2, -1, 1);
  tiny.tag(gone, {.never = true});
  const partners p(tiny);
  EXPECT_FALSE(p.are(wall, back) || p.are(wall, back + 1));
  EXPECT_TRUE(p.are(wall, sheet) || p.are(wall, sheet + 1));
  EXPECT_TRUE(p.are(back, sheet) || p.are(back, sheet + 1));
  EXPECT_TRUE(p.found.of(gone).empty());
  const partners both(tiny, true);
  EXPECT_TRUE(both.are(wall, back) || both.are(wall, back + 1));
}

TEST(coincident_partners, do_not_depend_on_threads) {
  // Threes on top of each other, more polygons than one task takes.
  tiny_scene tiny;
  for (int i = 0; i < 9'000; ++i) {
    const int three = i / 3;
    const float y = static_cast<float>(three % 60) + 0.01f * static_cast<float>(i % 3);
    const auto z = static_cast<float>(three / 60);
    tiny.triangle({2, y, z}, {2, y, z + 0.5f}, {2, y + 0.5f, z});
  }
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  const auto with = [&](int threads) {
    std::optional<coincident_partners> made;
    tbb::task_arena(threads).execute([&] { made.emplace(rays); });
    return std::move(*made);
  };
  const coincident_partners one = with(1), four = with(4);
  ASSERT_EQ(one.polygon_count(), 9'000u);
  ASSERT_EQ(one.polygon_count(), four.polygon_count());
  for (std::uint32_t i = 0; i < s.polygon_count; ++i) EXPECT_TRUE(std::ranges::equal(one.of(i), four.of(i))) << i;
}

// Stacks of three triangles, 4 mm apart, in a grid. If `without`, every fifth stack lacks its middle one, and a wall
// through all of them is not there, which only their own probes meet.
tiny_scene stacks(int count, bool without) {
  tiny_scene tiny;
  for (int i = 0; i < 3 * count; ++i) {
    const int stack = i / 3;
    if (without && i % 3 == 1 && stack % 5 == 0) continue;
    const float y = static_cast<float>(stack % 20), z = static_cast<float>(stack / 20);
    const float x = 2.0f + 0.004f * static_cast<float>(i % 3);
    tiny.triangle({x, y, z}, {x, y, z + 0.5f}, {x, y + 0.5f, z});
  }
  tiny.wall_x(300, -1, 300);  // makes the reach the largest, with either
  if (!without) tiny.wall_x(2.002f, -1, 60);
  return tiny;
}

// What was added is found, with the polygons around it, and what is known is not probed again.
TEST(coincident_partners, from_those_of_before_an_edit) {
  constexpr int count = 100;
  const partners before(stacks(count, true)), after(stacks(count, false));
  partners_before known{.reach = before.found.reach(), .pairs = {}, .added = {}};
  std::vector<std::uint32_t> new_of;
  for (std::uint32_t i = 0; i < after.s.polygon_count; ++i)
    if (i >= before.s.polygon_count + 20 || (i < 3 * count && i % 3 == 1 && i / 3 % 5 == 0))
      known.added.push_back(i);
    else
      new_of.push_back(i);
  for (const auto& [a, b] : before.found.pairs()) known.pairs.emplace_back(new_of[a], new_of[b]);
  ASSERT_EQ(known.added.size(), 22u);
  ASSERT_LT(known.pairs.size(), after.found.pairs().size());
  EXPECT_EQ(coincident_partners(after.rays, &known).pairs(), after.found.pairs());

  known.pairs.emplace_back(0u, 3u * count);
  const coincident_partners with_wrong(after.rays, &known);
  EXPECT_EQ(with_wrong.pairs().size(), after.found.pairs().size() + 1) << "pairs of before are taken over";
  known.reach *= 0.5f;
  EXPECT_EQ(coincident_partners(after.rays, &known).pairs(), after.found.pairs()) << "not those of another reach";
}

}  // namespace
}  // namespace sightcell::bake
