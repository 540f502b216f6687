#include "trace/duplicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <map>

#include "sightcell/bake/inspect.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using scene::alpha_mode;
using test::tiny_scene;
using ids = std::vector<std::uint32_t>;

constexpr glm::vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};

ids class_of(const duplicate_classes& classes, std::uint32_t polygon) {
  const auto members = classes.class_of(polygon);
  return {members.begin(), members.end()};
}

ids class_of(tiny_scene& s, std::uint32_t polygon, bool all_double_sided = false) {
  return class_of(duplicate_classes(scene::flatten(s.finished()), all_double_sided), polygon);
}

TEST(duplicates, every_rotation_is_one_class) {
  tiny_scene s;
  s.triangle(a, b, c), s.triangle(a, b, d), s.triangle(b, c, a), s.triangle(c, a, b);
  const duplicate_classes classes(scene::flatten(s.finished()), false);
  for (const std::uint32_t polygon : {0u, 2u, 3u}) EXPECT_EQ(class_of(classes, polygon), (ids{0, 2, 3}));
  EXPECT_TRUE(class_of(classes, 1).empty());
  EXPECT_EQ(classes.polygon_count(), 3u);
  EXPECT_EQ(classes.class_count(), 1u);
}

TEST(duplicates, another_facing_is_another_class) {
  tiny_scene s;
  s.triangle(a, b, c), s.triangle(a, c, b), s.triangle(c, b, a);
  EXPECT_TRUE(class_of(s, 0).empty());
  EXPECT_EQ(class_of(s, 1), (ids{1, 2}));
  EXPECT_EQ(class_of(s, 0, true), (ids{0, 1, 2}));
}

TEST(duplicates, what_is_seen_from_both_sides_has_no_facing) {
  tiny_scene s;
  const tiny_scene::look sheet{alpha_mode::opaque, true};
  s.triangle(a, b, c, sheet), s.triangle(a, c, b, sheet), s.triangle(a, b, c), s.triangle(a, c, b);
  EXPECT_EQ(class_of(s, 0), (ids{0, 1}));
  EXPECT_TRUE(class_of(s, 2).empty());  // of another kind, as the next
  EXPECT_TRUE(class_of(s, 3).empty());
  EXPECT_EQ(class_of(s, 2, true), (ids{0, 1, 2, 3}));
}

TEST(duplicates, another_kind_is_another_class) {
  tiny_scene s;
  s.triangle(a, b, c), s.triangle(a, b, c, {alpha_mode::blend, false}), s.triangle(a, b, c, {alpha_mode::blend, false});
  s.triangle(a, b, c), s.triangle(a, b, c);
  scene::world_geometry geometry = scene::flatten(s.finished());
  geometry.kinds[4].non_occluder = true;
  geometry.kinds[3].always = true;  // is seen and hides as the others do
  const duplicate_classes classes(geometry, false);
  EXPECT_EQ(class_of(classes, 0), (ids{0, 3}));
  EXPECT_EQ(class_of(classes, 1), (ids{1, 2}));
  EXPECT_TRUE(class_of(classes, 4).empty());
  EXPECT_EQ(classes.class_count(), 2u);
}

TEST(duplicates, absent_polygons_are_in_no_class) {
  tiny_scene s;
  s.triangle(a, b, c), s.triangle(a, b, c), s.triangle(a, b, c), s.triangle(a, b, b), s.triangle(a, b, b);
  scene::world_geometry geometry = scene::flatten(s.finished());
  geometry.kinds[1].absent = true;
  const duplicate_classes classes(geometry, false);
  EXPECT_EQ(class_of(classes, 0), (ids{0, 2}));
  EXPECT_TRUE(class_of(classes, 1).empty());
  EXPECT_TRUE(class_of(classes, 3).empty());
}

TEST(duplicates, minus_zero_is_zero_and_the_next_float_is_not) {
  tiny_scene s;
  s.triangle(a, b, c);
  s.triangle(a, b, c);
  s.triangle({std::nextafter(0.0f, 1.0f), 0, 0}, b, c);
  scene::world_geometry geometry = scene::flatten(s.finished());
  glm::vec3& corner = geometry.positions[geometry.indices[3]];
  ASSERT_EQ(corner, a);
  corner = {-0.0f, 0, -0.0f};
  EXPECT_EQ(class_of(duplicate_classes(geometry, false), 0), (ids{0, 1}));
}

TEST(duplicates, mirrored_instances_keep_their_facing) {
  // The mirror image of a box is the box, and what faced outward still does.
  tiny_scene s;
  s.closed_box({-1, -1, -1}, {1, 1, 1});
  scene::scene scene = s.finished();
  scene.draws.push_back(scene.draws[0]);
  scene.draws[1].to_world = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
  scene::finish(scene);
  const scene::world_geometry geometry = scene::flatten(scene);
  const duplicate_classes classes(geometry, false);
  // Of the faces across y and z the diagonals are mirrored into the other ones; those across x meet their images.
  EXPECT_EQ(classes.polygon_count(), 8u);
  EXPECT_EQ(count_coincident(geometry).any_winding, 8u);
  EXPECT_EQ(count_coincident(geometry).opposite, 0u);
}

TEST(duplicates, many_classes_are_told_apart) {
  tiny_scene s;
  std::map<std::uint32_t, ids> at;  // by place
  for (std::uint32_t id = 0; id < 1500; ++id) {
    const std::uint32_t place = id % 500 % (500 - 100 * (id / 500));
    const auto x = static_cast<float>(place);
    s.triangle({x, 0, 0}, {x, 1, 0}, {x, 0, 1});
    at[place].push_back(id);
  }
  const duplicate_classes classes(scene::flatten(s.finished()), false);
  std::uint32_t members = 0, several = 0;
  for (const auto& [place, all] : at) {
    for (const std::uint32_t id : all) EXPECT_EQ(class_of(classes, id), all.size() > 1 ? all : ids{});
    members += all.size() > 1 ? static_cast<std::uint32_t>(all.size()) : 0;
    several += all.size() > 1 ? 1 : 0;
  }
  EXPECT_EQ(classes.polygon_count(), members);
  EXPECT_EQ(classes.class_count(), several);
  EXPECT_EQ(several, 400u);
}

TEST(duplicates, coincident_polygons_are_counted_by_winding) {
  tiny_scene s;
  s.triangle(a, b, c), s.triangle(a, c, b), s.triangle(a, b, c);         // two of a class, one against them
  s.triangle(a, b, d), s.triangle(b, d, a, {alpha_mode::blend, false});  // the same winding, other kinds
  s.triangle(b, c, d);                                                   // alone
  s.triangle(a, c, d, {alpha_mode::mask, false}), s.triangle(a, d, c);   // opposite, other kinds
  const coincident_counts counts = count_coincident(scene::flatten(s.finished()));
  EXPECT_EQ(counts.duplicates, 2u);
  EXPECT_EQ(counts.any_winding, 7u);
  EXPECT_EQ(counts.opposite, 5u);
}

TEST(duplicates, nothing_is_found_in_an_empty_scene) {
  tiny_scene s;
  const duplicate_classes classes(scene::flatten(s.finished()), false);
  EXPECT_EQ(classes.polygon_count(), 0u);
  EXPECT_EQ(classes.class_count(), 0u);
  EXPECT_TRUE(classes.class_of(0).empty());
}

}  // namespace
}  // namespace sightcell::bake
