#include "sampler/nir04.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "unit/bake/sampler/sample_cell.h"
#include "unit/bake/sampler/scripted_source.h"

namespace sightcell::bake {
namespace {

using test::scripted_source;

TEST(quad_difference, is_the_largest_share_of_pixels_that_another_corner_sees_and_one_does_not) {
  const corner_view a{{1, 60}, {2, 40}}, b{{1, 50}, {3, 50}}, c{{1, 100}};
  const auto of = [](std::vector<const corner_view*> corners) { return quad_difference(corners, 100.0); };
  EXPECT_EQ(of({&a, &a, &a}), 0.0);
  EXPECT_EQ(of({&a, &b}), 0.5) << "a lacks 3";
  EXPECT_EQ(of({&a, &b, &c}), 0.9) << "c lacks 2 and 3";
  EXPECT_EQ(of({&a}), 0.0);
  EXPECT_EQ(of({}), 0.0);
}

TEST(nir04, divides_where_corners_see_different_polygons) {
  scripted_source source;
  // What looks toward +x sees another polygon from each half of the face's lower left quarter.
  source.answer = [](const pose& p, hemicube_view& view) {
    if (p.forward.x > 0.5f && p.eye.z > 2.0f && p.eye.y < 2.0f)
      view.seen = {{p.eye.y < 1.0f ? 1u : 2u, 3 * 64 * 64, 0}};
    else
      view.seen = {{3, 3 * 64 * 64, 0}};
  };
  cell_set set(10);
  const auto free = [](const glm::vec3&) { return true; };
  EXPECT_EQ(sample_cell({"nir04", 120, false, 1, 1}, {{0, 0, 0}, {4, 4, 4}}, {}, free, source, set), 120u);
  std::array<int, 2> on_face{};
  for (const pose& p : source.poses)
    if (p.forward.x > 0.5f) ++on_face[p.eye.z >= 2.0f && p.eye.y <= 2.0f ? 1 : 0];
  EXPECT_EQ(on_face[0] + on_face[1], 120 - 5 * 9) << "the other faces are the same everywhere";
  EXPECT_GT(on_face[1], 50);
  EXPECT_EQ(set.sorted(), (std::vector<std::uint32_t>{1, 2, 3}));
  std::set<std::array<float, 6>> places;
  for (const pose& p : source.poses) places.insert({p.eye.x, p.eye.y, p.eye.z, p.forward.x, p.forward.y, p.forward.z});
  EXPECT_EQ(places.size(), 120u) << "no hemicube twice";
}

TEST(nir04, ends_where_nothing_differs) {
  scripted_source source;
  source.answer = [](const pose&, hemicube_view& view) { view.seen = {{3, 10, 0}}; };
  cell_set set(10);
  const auto free = [](const glm::vec3&) { return true; };
  EXPECT_EQ(sample_cell({"nir04", 500, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 54u);
  EXPECT_EQ(sample_cell({"nir04", 40, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 24u);
  EXPECT_EQ(sample_cell({"nir04", 6, false, 1, 1}, {{0, 0, 0}, {4, 2, 4}}, {}, free, source, set), 6u);
}

TEST(nir04, a_cell_that_sees_much_is_sampled_in_parts) {
  scripted_source source;
  source.answer = [](const pose& p, hemicube_view& view) {
    view.seen = {{static_cast<std::uint32_t>(p.eye.x * 10.0f), 10, 0}};
  };
  const auto free = [](const glm::vec3&) { return true; };
  const box where{{0, 0, 0}, {4, 2, 3}};
  const auto inner = [&](std::uint32_t part_polygons) {
    source.poses.clear();
    cell_set set(100);
    const hemicube_plan plan{.samples = 600};
    hemicubes taken(plan, source, set);
    sample_nir04({.part_polygons = part_polygons}, where, free, taken);
    EXPECT_LE(taken.taken(), 600u);
    int on_the_cut = 0;
    for (const pose& p : source.poses) on_the_cut += std::abs(p.forward.x) > 0.5f && p.eye.x == 2.0f ? 1 : 0;
    return on_the_cut;
  };
  EXPECT_EQ(inner(0), 0);
  EXPECT_EQ(inner(50), 0);
  EXPECT_GT(inner(5), 10);
}

}  // namespace
}  // namespace sightcell::bake
