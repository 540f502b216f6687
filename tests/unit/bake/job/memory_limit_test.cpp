#include "job/memory_limit.h"

#include <gtest/gtest.h>

#include <string>

#include "errors/error_id.h"
#include "sightcell/base/error.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t mebibyte = 1u << 20;

scene::scene a_room() {
  test::tiny_scene tiny;
  tiny.closed_box({-2, -2, -2}, {2, 2, 2}, true);
  return tiny.finished();
}

// A scene that says it has so many polygons: nothing of it is looked at but numbers.
scene::scene of_size(std::uint32_t polygons) {
  scene::scene s = a_room();
  s.polygon_count = polygons;
  return s;
}

settings with_memory(std::uint64_t bytes) {
  settings how;
  how.memory = bytes;
  return how;
}

TEST(memory_limit, the_system_tells) {
  EXPECT_GT(resident_memory(), mebibyte);
  EXPECT_GE(peak_resident_memory(), resident_memory() / 2);
  EXPECT_LT(peak_resident_memory(), std::uint64_t{1} << 45);
}

TEST(memory_limit, a_scene_that_does_not_fit_is_refused) {
  const auto id = [](std::uint32_t polygons, std::uint64_t memory) {
    return test::error_id([&] { require_memory(of_size(polygons), with_memory(memory)); });
  };
  EXPECT_EQ(id(1'000'000, 300 * mebibyte), "bake.memory");
  EXPECT_EQ(id(1'000'000, 2000 * mebibyte), "");
  EXPECT_EQ(id(10'000'000, 2000 * mebibyte), "bake.memory");
  EXPECT_EQ(id(10'000'000, 0), "") << "no limit";
  EXPECT_EQ(id(12, mebibyte), "bake.memory") << "the process itself takes more";
}

TEST(memory_limit, what_is_not_built_is_not_counted) {
  const scene::scene s = of_size(1'000'000);
  settings how;
  how.source = "cpu";
  const std::uint64_t all = memory_of_scene(s, how);
  how.suns.resize(2);
  EXPECT_EQ(memory_of_scene(s, how), all + 16'000'000) << "shadows of one sun at a time";
  how.suns.clear();
  how.max_pixel_error = 0.0;
  EXPECT_EQ(memory_of_scene(s, how), all) << "guided looks beside what it knows without an error to reach, too";
  how.sampler = "halton";
  const std::uint64_t without_neighbors = memory_of_scene(s, how);
  how.source = "rays";
  EXPECT_LT(without_neighbors, all);
  const std::uint64_t without_source = memory_of_scene(s, how);
  EXPECT_LT(without_source, without_neighbors);
  how.source = "cpu";
  how.sampler = "gvs";
  EXPECT_EQ(memory_of_scene(s, how), without_source) << "no hemicube is drawn";
}

TEST(memory_limit, an_alpha_test_takes_memory) {
  scene::scene s = of_size(1'000'000);
  const std::uint64_t without = memory_of_scene(s, {});
  s.materials.resize(1);
  s.materials[0].alpha = scene::alpha_mode::mask;
  s.draws.resize(1);
  s.draws[0].material = 0;
  s.draws[0].polygon_count = s.polygon_count;
  EXPECT_EQ(memory_of_scene(s, {}), without + 400'000'000);
}

TEST(memory_limit, floors_of_a_wide_scene_take_memory) {
  settings how;
  EXPECT_GT(memory_of_floors(500.0, 500.0, how), 60 * mebibyte);
  EXPECT_EQ(memory_of_floors(1e6, 1e6, how), memory_of_floors(600.0, 600.0, how)) << "columns get wider";
  EXPECT_LT(memory_of_floors(10.0, 10.0, how), mebibyte);
  const auto id = [](std::uint64_t memory) {
    const scene::scene s = a_room();
    scene::world_geometry geometry = scene::flatten(s);
    geometry.max.x += 1000.0f, geometry.max.z += 1000.0f;
    return test::error_id([&] { require_memory(s, with_memory(memory), &geometry); });
  };
  EXPECT_EQ(id(resident_memory() + 90 * mebibyte), "bake.memory");
  EXPECT_EQ(id(resident_memory() + 300 * mebibyte), "");
  how.cells_grid = {{0, 0, 0, 1, 1, 1}};
  EXPECT_EQ(memory_of_floors(500.0, 500.0, how), 0u) << "nobody looks for floors";
}

TEST(memory_limit, fewer_lanes_where_they_do_not_fit) {
  EXPECT_EQ(workers_that_fit(16, 1 << 30, {}), 16u) << "no limit";
  const std::uint64_t room = resident_memory() + 1000 * mebibyte;
  EXPECT_EQ(workers_that_fit(16, 10 * mebibyte, with_memory(room)), 16u);
  const std::size_t some = workers_that_fit(16, 200 * mebibyte, with_memory(room));
  EXPECT_GE(some, 4u);
  EXPECT_LE(some, 5u);
  EXPECT_EQ(workers_that_fit(16, 200 * mebibyte, with_memory(1)), 1u) << "one there always is";
  EXPECT_EQ(workers_that_fit(1, 200 * mebibyte, with_memory(room)), 1u);
}

}  // namespace
}  // namespace sightcell::bake
