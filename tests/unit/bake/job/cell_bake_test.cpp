// Whole cells on scenes of a few polygons: what the set has to hold, and what it must not.
#include "job/cell_bake.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "hemicube/gpu/gpu_source.h"
#include "search/near_polygons.h"
#include "sightcell/base/error.h"
#include "sightcell/base/random.h"
#include "sightcell/picture/gl_context.h"
#include "trace/viewpoints.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;
constexpr tiny_scene::look glass{scene::alpha_mode::blend, false};

const picture::gl_context* context() {
  static const auto made = []() -> std::unique_ptr<picture::gl_context> {
    try {
      return std::make_unique<picture::gl_context>();
    } catch (const error& e) {
      std::fprintf(stderr, "skipped: %s\n", e.what());
      return nullptr;
    }
  }();
  return made.get();
}

class cell_bake : public testing::Test {
 protected:
  void SetUp() override {
    if (!context()) GTEST_SKIP() << "no EGL context";
  }

  cell_record bake(tiny_scene tiny, const view_cell& cell, settings how = {}, bool checked = true) {
    const scene::scene s = tiny.finished();
    const scene::world_geometry geometry = scene::flatten(s);
    const ray_scene rays(geometry, how.all_double_sided);
    const near_polygons neighbors(rays);
    const duplicate_classes duplicates(geometry, how.all_double_sided);
    const auto source = make_gpu_source(*context(), geometry, {.resolution = 64, .far_plane = 100.0f});
    const overrides none;
    const auto sampler = make_cell_sampler(how, {rays, *source, nullptr, {}, &neighbors});
    const cell_baker baker(how, none, rays, &neighbors, duplicates, *sampler);
    cell_set set = baker.make_set();
    cell_record record = baker.finished(cell, baker.sample_and_finish(cell, set));
    if (checked && how.max_pixel_error > 0.0 && record.stored) expect_as_brute_force(rays, cell, how, record);
    return record;
  }

  // Everything that 400,000 rays of their own find is in the set; what they never find has to be a polygon inside the
  // grown box (rule 4 takes those that face a free place even where they are hard to see) or a sliver of the rays.
  static void expect_as_brute_force(const ray_scene& rays, const view_cell& cell, const settings& how,
                                    const cell_record& record) {
    const box grown = box{cell.min, cell.max}.grown(how.margin);
    random_stream random(99, 99, purpose::verify);
    std::uint64_t tries = 0;
    const auto eyes = draw_viewpoints(rays, grown, how.player_radius, 4'000, 400'000, random, tries);
    std::vector<std::uint64_t> hits(rays.geometry().kinds.size());
    sight seen;
    std::vector<std::uint32_t> coincident;
    for (const glm::vec3& eye : eyes)
      for (int i = 0; i < 100; ++i) {
        const glm::vec3 direction = random.on_sphere();
        rays.trace(eye, direction, seen);
        for (const passed_polygon& p : seen.before) ++hits[p.polygon];
        if (seen.front == no_polygon) continue;
        rays.coincident(eye, direction, seen.distance, coincident);
        for (const std::uint32_t polygon : coincident) ++hits[polygon];
      }
    const std::set<std::uint32_t> set(record.set.begin(), record.set.end());
    const auto inside = rays.touching(grown.min, grown.max);
    for (std::uint32_t polygon = 0; polygon < hits.size(); ++polygon) {
      if (hits[polygon] >= 400) {
        EXPECT_TRUE(set.contains(polygon)) << "polygon " << polygon << " is seen by " << hits[polygon] << " rays";
      }
      const scene::polygon_kind kind = rays.geometry().kinds[polygon];
      const bool untraced = kind.always || kind.absent;  // by its tags, or a coarser level of detail
      if (set.contains(polygon) && hits[polygon] == 0 && !untraced) {
        EXPECT_TRUE(std::binary_search(inside.begin(), inside.end(), polygon))
            << "polygon " << polygon << " is not seen";
      }
    }
  }

  static bool has(const cell_record& record, std::uint32_t first, std::uint32_t count = 2) {
    const std::set<std::uint32_t> set(record.set.begin(), record.set.end());
    for (std::uint32_t i = first; i < first + count; ++i)
      if (!set.contains(i)) return false;
    return true;
  }
  static bool has_any(const cell_record& record, std::uint32_t first, std::uint32_t count = 2) {
    const std::set<std::uint32_t> set(record.set.begin(), record.set.end());
    for (std::uint32_t i = first; i < first + count; ++i)
      if (set.contains(i)) return true;
    return false;
  }
};

const view_cell around_origin{{-1, -1, -1}, {1, 1, 1}, "", 7};

TEST_F(cell_bake, a_wall_hides_what_is_behind_it) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(4, -1, 30), behind = tiny.wall_x(6, -1, 3), beside = tiny.wall_x(-6, 1, 3);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(record.bound_met);
  EXPECT_TRUE(has(record, wall));
  EXPECT_TRUE(has(record, beside));
  EXPECT_FALSE(has_any(record, behind));
}

TEST_F(cell_bake, walls_turned_away_are_not_seen_and_hide_nothing) {
  tiny_scene tiny;
  // Small and in a room, or seeing so many backs would tell that the cell lies in a solid.
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto back = tiny.wall_x(4, +1, 1), behind = tiny.wall_x(6, -1, 1);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(record.stored);
  EXPECT_FALSE(has_any(record, back));
  EXPECT_TRUE(has(record, behind));
  settings both;
  both.all_double_sided = true;
  EXPECT_TRUE(has(bake(tiny, around_origin, both), back)) << "rays see both sides with --all-double-sided";
}

TEST_F(cell_bake, glass_is_seen_through) {
  tiny_scene tiny;
  const auto pane = tiny.wall_x(3, -1, 4, glass), second = tiny.wall_x(4, -1, 4, glass), wall = tiny.wall_x(5, -1, 30);
  const auto hidden = tiny.wall_x(6, -1, 3, glass);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(has(record, pane) && has(record, second) && has(record, wall));
  EXPECT_FALSE(has_any(record, hidden));
}

TEST_F(cell_bake, all_sides_of_a_pillar_inside_are_in_the_set) {
  tiny_scene tiny;
  const auto pillar = tiny.closed_box({-0.2f, -3, -0.2f}, {0.2f, 3, 0.2f});
  const auto core = tiny.closed_box({-0.1f, -2, -0.1f}, {0.1f, 2, 0.1f});  // inside the pillar
  const auto room = tiny.closed_box({-5, -5, -5}, {5, 5, 5}, true);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(has(record, room, 12));
  // The four sides; its top and bottom face away from everything in the cell.
  const std::set<std::uint32_t> set(record.set.begin(), record.set.end());
  int sides = 0;
  for (std::uint32_t i = pillar; i < pillar + 12; ++i) sides += set.contains(i);
  EXPECT_EQ(sides, 8);
  // The core touches the cell and faces its places, so rule 4 takes the sides that look out, though the pillar hides
  // them; never its top and bottom.
  int core_sides = 0;
  for (std::uint32_t i = core; i < core + 12; ++i) core_sides += set.contains(i);
  EXPECT_EQ(core_sides, 8);
}

TEST_F(cell_bake, an_underside_just_above_the_ground_of_a_cell_is_in_the_set_where_an_eye_fits_below) {
  tiny_scene tiny;
  tiny.closed_box({-5, -3, -5}, {5, 45, 5}, true);
  const auto facing_down = [&](float x, float y) {
    return tiny.quad({x, y, 0.2f}, {x + 0.3f, y, 0.2f}, {x + 0.3f, y, 0.5f}, {x, y, 0.5f});
  };
  const auto open = facing_down(0.2f, -1.19f), covered = facing_down(-0.6f, -1.19f);
  tiny.quad({-0.6f, -1.24f, 0.5f}, {-0.3f, -1.24f, 0.5f}, {-0.3f, -1.24f, 0.2f}, {-0.6f, -1.24f, 0.2f});
  settings how;
  how.max_pixel_error = 0.0;
  how.samples = 6;
  // The grown cell begins at -1.25 and is 40 m high: of 128 free points none lies so low.
  const cell_record record = bake(tiny, {{-1, -1, -1}, {1, 39, 1}, "", 7}, how);
  EXPECT_TRUE(has(record, open));
  EXPECT_FALSE(has_any(record, covered));
}

TEST_F(cell_bake, a_cell_half_in_a_wall_does_not_open_it) {
  // A closed room; the cell reaches through its wall into the solid between this room and the next.
  tiny_scene tiny;
  const auto room = tiny.closed_box({-5, -5, -5}, {0, 5, 5}, true);
  const auto next = tiny.closed_box({2, -5, -5}, {9, 5, 5}, true);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(record.stored);
  EXPECT_TRUE(has(record, room, 12));
  EXPECT_FALSE(has_any(record, next, 12));
}

TEST_F(cell_bake, a_cell_inside_a_solid_is_not_stored) {
  tiny_scene tiny;
  tiny.closed_box({-5, -5, -5}, {5, 5, 5});
  EXPECT_FALSE(bake(tiny, around_origin).stored);
}

TEST_F(cell_bake, the_margin_counts) {
  // A deep slit above the cell: what lies behind it is seen from the margin alone, which reaches up to it.
  tiny_scene tiny;
  const auto target = tiny.deep_slit();
  settings narrow, wide;
  narrow.margin = 0.0f;
  wide.margin = 0.25f;
  const view_cell cell{{0, -0.5f, 0}, {0.5f, 0.5f, 0.85f}, "", 3};
  EXPECT_FALSE(has_any(bake(tiny, cell, narrow), target));
  EXPECT_TRUE(has_any(bake(tiny, cell, wide), target));
}

TEST_F(cell_bake, the_sampler_alone_finds_what_has_pixels) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(4, -1, 30), behind = tiny.wall_x(6, -1, 3);
  for (const char* sampler : {"importance-depth", "halton"}) {
    settings how;
    how.sampler = sampler;
    how.max_pixel_error = 0.0;
    const cell_record record = bake(tiny, around_origin, how);
    EXPECT_EQ(record.samples, how.samples);
    EXPECT_EQ(record.rays, 0u);
    EXPECT_EQ(record.upper_bound, 1.0);
    EXPECT_TRUE(has(record, wall));
    EXPECT_FALSE(has_any(record, behind));
  }
}

TEST_F(cell_bake, what_lies_in_the_same_place_is_seen_together) {
  // A wall of two layers back to back, modeled twice: its backs do not make a solid of the room.
  tiny_scene tiny;
  const auto wall = tiny.wall_x(4, -1, 30), again = tiny.wall_x(4, -1, 30), decal = tiny.wall_x(4.0001f, -1, 1);
  const auto back = tiny.wall_x(4, 1, 30), behind = tiny.wall_x(4.005f, -1, 1);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(has(record, wall) && has(record, again));
  EXPECT_TRUE(has(record, decal)) << "0.1 mm behind";
  EXPECT_FALSE(has_any(record, back) || has_any(record, behind));
}

TEST_F(cell_bake, nothing_is_seen_through_a_crack) {
  for (const float width : {0.0001f, 0.005f}) {
    tiny_scene tiny;
    tiny.quad({3, -9, width / 2}, {3, -9, 9}, {3, 9, 9}, {3, 9, width / 2});
    tiny.quad({3, -9, -9}, {3, -9, -width / 2}, {3, 9, -width / 2}, {3, 9, -9});
    const auto behind = tiny.wall_x(5, -1, 3);
    const cell_record record = bake(tiny, around_origin);
    EXPECT_EQ(has_any(record, behind), width > 0.004f) << width;
  }
}

TEST_F(cell_bake, tags_say_what_is_in_every_set_and_in_none) {
  tiny_scene tiny;
  tiny.wall_x(4, -1, 30);
  const auto sky = tiny.wall_x(8, -1, 3), bird = tiny.wall_x(9, -1, 3), door = tiny.wall_x(3, -1, 2),
             player = tiny.wall_x(2, -1, 2), ghost = tiny.wall_x(2.5f, -1, 2), beyond = tiny.wall_x(7, -1, 3);
  tiny.tag(sky, {.always = true});
  tiny.tag(bird, {.animated = true});
  tiny.tag(door, {.occluder = false});
  tiny.tag(beyond, {.occluder = false});
  tiny.tag(player, {.dynamic = true});
  tiny.tag(ghost, {.never = true});
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(has(record, sky) && has(record, bird) && has(record, door));
  EXPECT_FALSE(has_any(record, player) || has_any(record, ghost) || has_any(record, beyond));
}

TEST_F(cell_bake, coarser_levels_come_with_the_finest) {
  tiny_scene tiny;
  tiny.wall_x(4, -1, 30);
  const auto near = tiny.wall_x(3, -1, 1), near_coarse = tiny.wall_x(3, -1, 2), far = tiny.wall_x(6, -1, 1),
             far_coarse = tiny.wall_x(6, -1, 2);
  tiny.level(near, 1, 0), tiny.level(near_coarse, 1, 1), tiny.level(far, 2, 0), tiny.level(far_coarse, 2, 1);
  const cell_record record = bake(tiny, around_origin);
  EXPECT_TRUE(has(record, near) && has(record, near_coarse));
  EXPECT_FALSE(has_any(record, far) || has_any(record, far_coarse));
}

TEST_F(cell_bake, ids_decide_nothing) {
  // The same polygons in the opposite order. Few samples, so that dilation has a part in the set.
  std::vector<std::array<glm::vec3, 3>> triangles;
  random_stream random(5, 5, purpose::verify);
  for (int strip = 0; strip < 200; ++strip) {
    glm::vec3 a = 6.0f * random.on_sphere();
    glm::vec3 b = a + 0.5f * random.on_sphere();
    for (int i = 0; i < 12; ++i) {
      const glm::vec3 c = b + 0.5f * random.on_sphere();
      triangles.push_back({a, b, c});
      a = b, b = c;
    }
  }
  settings how;
  how.samples = 6;
  how.max_pixel_error = 0.05;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  const auto set_of = [&](bool turned) {
    tiny_scene tiny;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto& t = triangles[turned ? count - 1 - i : i];
      tiny.triangle(t[0], t[1], t[2], {scene::alpha_mode::opaque, true});
    }
    std::vector<std::uint32_t> set = bake(tiny, around_origin, how, false).set;
    if (turned)
      for (std::uint32_t& id : set) id = count - 1 - id;
    std::sort(set.begin(), set.end());
    return set;
  };
  const std::vector<std::uint32_t> one = set_of(false), other = set_of(true);
  EXPECT_GT(one.size(), 500u);
  EXPECT_EQ(one, other);
}

TEST_F(cell_bake, every_cell_starts_afresh) {
  tiny_scene tiny;
  const auto first_room = tiny.closed_box({-5, -5, -5}, {5, 5, 5}, true);
  const auto second_room = tiny.closed_box({15, -5, -5}, {25, 5, 5}, true);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  const near_polygons neighbors(rays);
  const duplicate_classes duplicates(geometry, false);
  const auto source = make_gpu_source(*context(), geometry, {.resolution = 64, .far_plane = 100.0f});
  const settings how;
  const overrides none;
  const auto sampler = make_cell_sampler(how, {rays, *source, nullptr, {}, &neighbors});
  const cell_baker baker(how, none, rays, &neighbors, duplicates, *sampler);
  cell_set set = baker.make_set();
  (void)baker.sample_and_finish(around_origin, set);
  const cell_record second = baker.sample_and_finish({{19, -1, -1}, {21, 1, 1}, "", 8}, set);
  EXPECT_TRUE(has(second, second_room, 12));
  EXPECT_FALSE(has_any(second, first_room, 12));
}

TEST_F(cell_bake, repeats_itself) {
  tiny_scene tiny;
  tiny.closed_box({-5, -5, -5}, {5, 5, 5}, true);
  tiny.closed_box({0.3f, -1, -0.2f}, {0.6f, 0.4f, 0.9f});
  EXPECT_EQ(bake(tiny, around_origin), bake(tiny, around_origin));
}

}  // namespace
}  // namespace sightcell::bake
