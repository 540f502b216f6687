#include "bound/verification_rays.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::gridded_room;
using test::room_middle;
using test::scene_with_rays;
using test::tiny_scene;

TEST(verification_rays, count_what_the_set_lacks) {
  const scene_with_rays w(gridded_room(2));
  // From the room_middle of a cube's room each wall is hit by a sixth of the rays: leave one wall out.
  const auto batch = cast_verification_rays(w.rays, room_middle, {}, 60'000, {1, 1, purpose::bound, 1},
                                            [&](std::uint32_t p) { return p >= 8; });
  EXPECT_EQ(batch.rays, 60'000u);
  EXPECT_NEAR(static_cast<double>(batch.misses) / 60'000.0, 1.0 / 6.0, 0.01);
  EXPECT_EQ(batch.misses, batch.missed.size());
}

TEST(verification_rays, do_not_depend_on_threads) {
  const scene_with_rays w(gridded_room(3));
  const auto cast = [&](int threads) {
    verification_batch batch;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      batch = cast_verification_rays(w.rays, room_middle, {}, 5'000, {1, 1, purpose::bound, 1},
                                     [&](std::uint32_t p) { return p % 7 != 0; });
    });
    return batch;
  };
  const verification_batch one = cast(1), four = cast(4);
  EXPECT_EQ(one.misses, four.misses);
  ASSERT_EQ(one.missed.size(), four.missed.size());
  for (std::size_t i = 0; i < one.missed.size(); ++i) {
    EXPECT_EQ(one.missed[i].polygon, four.missed[i].polygon);
    EXPECT_EQ(one.missed[i].eye, four.missed[i].eye);
  }
}

TEST(verification_rays, a_place_without_free_points_ends) {
  tiny_scene tiny;
  tiny.closed_box({-3, -3, -3}, {3, 3, 3});
  const scene_with_rays w(tiny);
  const auto batch = cast_verification_rays(w.rays, room_middle, {}, 64, {1, 1, purpose::bound, 1},
                                            [](std::uint32_t) { return true; });
  EXPECT_EQ(batch.rays, 0u);
  EXPECT_EQ(batch.viewpoints_tested, 64u * 256u);
}

}  // namespace
}  // namespace sightcell::bake
