#include "search/hemicubes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "sampler/face_sampling.h"
#include "sightcell/base/random.h"
#include "unit/bake/sampler/scripted_source.h"

namespace sightcell::bake {
namespace {

using test::scripted_source;

TEST(hemicubes, jitter_turns_by_at_most_half_a_pixel) {
  const pose straight;
  double most = 0.0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const pose turned = jittered(straight, 64, random_stream(1, 1, purpose::jitter, 0, i));
    EXPECT_NEAR(glm::length(turned.right), 1.0, 1e-6);
    EXPECT_NEAR(glm::dot(turned.right, turned.up), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(glm::cross(turned.forward, turned.up), turned.right), 0.0, 1e-6);
    const double right = std::abs(glm::dot(turned.forward, straight.right)),
                 up = std::abs(glm::dot(turned.forward, straight.up));
    EXPECT_LT(std::max(right, up), 0.5 * 2.0 / 64);
    most = std::max(most, right);
  }
  EXPECT_GT(most, 0.4 * 2.0 / 64);
}

TEST(hemicubes, a_limit_of_time_ends_a_cell) {
  scripted_source source;
  cell_set set(10);
  const time_limit over(1e-9, true);
  const hemicube_plan plan{.samples = 1000, .limit = &over};
  hemicubes taken(plan, source, set);
  sample_faces(
      {.sampler = "halton"}, plan, {{0, 0, 0}, {4, 2, 4}}, [](const glm::vec3&) { return true; }, taken);
  EXPECT_LE(taken.taken(), 6u);
}

TEST(hemicubes, are_weighed_before_what_they_see_joins) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view& view) {
    view.seen = {{3, 10, 0}};
    view.importance = {1, 2, 3, 4};
  };
  cell_set set(10);
  const hemicube_plan plan{.samples = 4};
  hemicubes taken(plan, source, set);
  const std::array<pose, 2> poses{};
  std::array<hemicube_view, 2> views;
  const importance_weight weigh = [&](const pose&, const hemicube_view&) { return set.contains(3) ? 1.0 : 2.0; };
  taken.take(poses, views, weigh);
  EXPECT_EQ(views[0].importance, (std::array<double, 4>{2, 4, 6, 8}));
  EXPECT_EQ(views[1].importance, (std::array<double, 4>{2, 4, 6, 8})) << "a round is weighed by what was before it";
  taken.take(poses, views, weigh);
  EXPECT_EQ(views[0].importance, (std::array<double, 4>{1, 2, 3, 4}));
}

TEST(hemicubes, cubes_leave_time_for_the_faces) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view&) {
    for (const double began = thread_cpu_seconds(); thread_cpu_seconds() - began < 1e-4;) continue;
  };
  cell_set set(10);
  const std::vector<glm::vec3> interior(100'000, glm::vec3{2, 1, 2});
  const time_limit limit(0.1, true);
  const hemicube_plan plan{.samples = 100'000, .geometry_inside = true, .interior_share = 0.25, .limit = &limit};
  hemicubes taken(plan, source, set);
  taken.take_interior(interior);
  const std::uint32_t cubes = taken.taken();
  EXPECT_GT(cubes, 32u);
  EXPECT_LT(cubes, 500u);
  EXPECT_GT(taken.left(), 0u);
}

}  // namespace
}  // namespace sightcell::bake
