// A wall across a hall and a box behind it, and what hosts with levels of detail of both draw.
#include "sightcell/bake/verify_levels.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "errors/error_id.h"
#include "file/pvs_output.h"
#include "sightcell/scene/object_levels.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t hall = 0, wall = 1, box_behind = 2;  // draws

class object_levels : public testing::Test {
 protected:
  object_levels() {
    test::tiny_scene tiny;
    tiny.closed_box({-4, -4, -4}, {20, 4, 4}, true);
    tiny.closed_box({8, -4, -4}, {8.2f, 4, 4});
    tiny.closed_box({12, -1, -1}, {13, 1, 1});
    scene_ = tiny.finished();
    write({hall, wall});
  }

  // Writes a file of one cell at the origin whose set has these draws.
  void write(const std::vector<std::uint32_t>& draws) {
    settings how;
    how.margin = 0.0f;
    std::vector<cell_record> records(1);
    for (const std::uint32_t d : draws)
      for (std::uint32_t i = 0; i < 12; ++i) records[0].set.push_back(scene_.draws[d].first_source + i);
    summary sum;
    write_pvs(
        frame_of(scene_, how, describe(how), {view_cell{{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}, "", 1}}),
        [&](std::uint32_t cell) { return records[cell]; }, path(), {}, sum);
  }

  // A coarser level of boxes.
  struct boxes {
    scene::level_switch begins;
    std::vector<std::pair<glm::vec3, glm::vec3>> corners;
  };

  static scene::object_levels levels_of(std::uint32_t draw, const boxes& level, float least_coverage = 0.0f) {
    test::tiny_scene tiny;
    for (const auto& [low, high] : level.corners) tiny.closed_box(low, high);
    scene::object_levels out{tiny.finished(), {}};
    out.objects.push_back({{draw}, {{level.begins, {0, out.coarser.polygon_count}}}, least_coverage});
    return out;
  }

  // The wall with a slit of one meter.
  static scene::object_levels slit(const scene::level_switch& begins, float least_coverage = 0.0f) {
    return levels_of(wall, {begins, {{{8, -4, -4}, {8.2f, 4, -0.5f}}, {{8, -4, 0.5f}, {8.2f, 4, 4}}}}, least_coverage);
  }

  level_verification check(const scene::object_levels& levels, double fov = 60.0, std::uint32_t threads = 0) const {
    return verify_levels(scene_, levels, test::file_bytes(path()), "levels.pvs", {.rays = 20'000, .threads = threads},
                         fov, {});
  }

  std::filesystem::path path() const { return folder_.path() / "levels.pvs"; }

  test::fresh_folder folder_;
  scene::scene scene_;
};

TEST_F(object_levels, with_a_slit_reveal_what_no_set_has) {
  const level_verification v = check(slit({.from_distance = 5.0f}));
  EXPECT_EQ(v.rays, 20'000u);
  EXPECT_GT(v.misses, 10u);
  EXPECT_EQ(v.misses_revealed, v.misses);
  EXPECT_EQ(v.misses_of_set + v.misses_at_levels, 0u);
  EXPECT_GT(v.upper_bound, v.pixel_error);
  EXPECT_GT(v.rays_at_levels, 1000u);
  EXPECT_EQ(v.objects, 1u);
  EXPECT_EQ(v.levels, 1u);
  ASSERT_EQ(v.missing.size(), 1u);
  EXPECT_EQ(v.missing[0].kind, level_miss::revealed);
  EXPECT_EQ(v.missing[0].draw, box_behind);
  EXPECT_EQ(v.missing[0].before, wall);
  EXPECT_EQ(v.missing[0].level, 0u);
  EXPECT_EQ(v.missing[0].polygon / 12, box_behind);
  EXPECT_EQ(v.missing[0].rays, v.misses);
  EXPECT_NEAR(v.missing[0].target[0], 12.0f, 1e-3f);
}

TEST_F(object_levels, that_are_closed_and_those_that_are_too_far_miss_nothing) {
  const level_verification closed =
      check(levels_of(wall, {{.from_distance = 5.0f}, {{{8.05f, -4, -4}, {8.1f, 4, 4}}}}));
  EXPECT_EQ(closed.misses, 0u);
  EXPECT_GT(closed.rays_at_levels, 1000u);
  const level_verification far = check(slit({.from_distance = 9.0f}));
  EXPECT_EQ(far.misses, 0u);
  EXPECT_EQ(far.rays_at_levels, 0u);
}

TEST_F(object_levels, that_cover_more_show_objects_that_no_set_has) {
  const scene::object_levels long_box = levels_of(box_behind, {{.from_distance = 5.0f}, {{{6, -1, -1}, {13, 1, 1}}}});
  level_verification v = check(long_box);
  EXPECT_GT(v.misses, 10u);
  EXPECT_EQ(v.misses_at_levels, v.misses);
  ASSERT_EQ(v.missing.size(), 1u);
  EXPECT_EQ(v.missing[0].kind, level_miss::at_level);
  EXPECT_EQ(v.missing[0].draw, box_behind);
  EXPECT_EQ(v.missing[0].level, 1u);
  EXPECT_EQ(v.missing[0].polygon, scene::no_index);
  EXPECT_NEAR(v.missing[0].target[0], 6.0f, 1e-3f);
  write({hall, wall, box_behind});
  v = check(long_box);
  EXPECT_EQ(v.misses, 0u) << "one polygon of level 0 suffices";
  EXPECT_GT(v.rays_at_levels, 10u);
}

TEST_F(object_levels, are_told_from_what_the_set_lacks_without_them) {
  write({hall});
  const level_verification v = check(slit({.from_distance = 100.0f}));
  const verification plain =
      verify(scene_, test::file_bytes(path()), "levels.pvs", {.rays = 20'000}, verify_progress{});
  EXPECT_GT(plain.misses, 100u);
  EXPECT_EQ(v.misses, plain.misses) << "the rays are the same";
  EXPECT_EQ(v.misses_of_set, v.misses);
}

// The sphere of the wall has a radius of 5.66 m, and its center is 8.1 m from the cell.
TEST_F(object_levels, begin_where_coverage_says) {
  EXPECT_GT(check(slit({.below_coverage = 1.3f})).misses, 10u) << "7.5 m";
  EXPECT_EQ(check(slit({.below_coverage = 1.1f})).misses, 0u) << "8.9 m";
  EXPECT_GT(check(slit({.below_coverage = 1.1f}), 90.0).misses, 10u) << "5.1 m";
  EXPECT_EQ(check(slit({.below_coverage = 0.0f})).misses, 0u) << "never";
  const level_verification gone = check(slit({.below_coverage = 1.3f}, 1.25f));
  EXPECT_GT(gone.misses_revealed, 10u) << "nothing of the wall is drawn from 7.8 m on";
  EXPECT_EQ(gone.rays_at_levels, 0u);
}

TEST_F(object_levels, without_a_switch_are_counted_and_never_drawn) {
  scene::object_levels levels = slit({.from_distance = 9.0f});
  levels.objects[0].coarser.push_back({{}, {0, levels.coarser.polygon_count}});
  const level_verification v = check(levels);
  EXPECT_EQ(v.levels_without_switch, 1u);
  EXPECT_EQ(v.misses, 0u);
  EXPECT_EQ(test::error_id([&] { (void)check(slit({})); }), "scene.no-levels");
  EXPECT_EQ(test::error_id([&] { (void)check({}); }), "scene.no-levels");
  scene::object_levels of_nothing = slit({.from_distance = 5.0f});
  of_nothing.objects[0].finest.clear();
  EXPECT_EQ(test::error_id([&] { (void)check(of_nothing); }), "scene.no-levels");
}

TEST_F(object_levels, are_the_same_with_any_number_of_threads) {
  const level_verification one = check(slit({.from_distance = 5.0f}), 60.0, 1);
  const level_verification two = check(slit({.from_distance = 5.0f}), 60.0, 2);
  EXPECT_EQ(one.misses, two.misses);
  EXPECT_EQ(one.rays_at_levels, two.rays_at_levels);
  EXPECT_EQ(one.missing[0].eye, two.missing[0].eye);
}

TEST_F(object_levels, need_a_field_of_view) {
  for (const double fov : {0.0, -60.0, 180.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(test::error_id([&] { (void)check(slit({.from_distance = 5.0f}), fov); }), "settings.out-of-range");
}

}  // namespace
}  // namespace sightcell::bake
