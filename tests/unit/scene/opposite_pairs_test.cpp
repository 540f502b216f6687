// A leaf and its back in the same place are one double-sided leaf.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

constexpr glm::vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};

// One triangle per draw, each with a material of its own.
class leaves {
 public:
  leaves& add(glm::vec3 p, glm::vec3 q, glm::vec3 r, alpha_mode alpha = alpha_mode::mask, bool double_sided = false) {
    draw leaf;
    leaf.material = leaf.geometry = static_cast<std::uint32_t>(scene_.draws.size());
    scene_.materials.emplace_back();
    scene_.materials.back().alpha = alpha;
    scene_.materials.back().double_sided = double_sided;
    scene_.geometries.push_back({{p, q, r}, {}, {0, 1, 2}});
    scene_.draws.push_back(leaf);
    return *this;
  }
  draw& last() { return scene_.draws.back(); }
  std::vector<bool> double_sided() {
    finish(scene_);
    std::vector<bool> sides;
    for (const polygon_kind kind : flatten(scene_).kinds) sides.push_back(kind.double_sided);
    return sides;
  }

 private:
  scene scene_;
};

using sides = std::vector<bool>;

TEST(opposite_pairs, a_leaf_and_its_back_are_double_sided) {
  EXPECT_EQ(leaves().add(a, b, c).add(b, c, d).add(c, b, a).double_sided(), (sides{true, false, true}));
}

TEST(opposite_pairs, every_rotation_of_the_back_is_found) {
  for (const auto& back : {std::array{a, c, b}, std::array{c, b, a}, std::array{b, a, c}})
    EXPECT_EQ(leaves().add(a, b, c).add(back[0], back[1], back[2]).double_sided(), (sides{true, true}));
}

TEST(opposite_pairs, two_leaves_that_face_the_same_way_stay_single_sided) {
  EXPECT_EQ(leaves().add(a, b, c).add(b, c, a).add(c, a, b).double_sided(), (sides{false, false, false}));
}

TEST(opposite_pairs, all_leaves_of_one_place_become_double_sided) {
  EXPECT_EQ(leaves().add(a, b, c).add(b, c, a).add(a, c, b).double_sided(), (sides{true, true, true}));
}

TEST(opposite_pairs, only_masks_count) {
  for (const alpha_mode other : {alpha_mode::opaque, alpha_mode::blend}) {
    EXPECT_EQ(leaves().add(a, b, c).add(a, c, b, other).double_sided(), (sides{false, false}));
    EXPECT_EQ(leaves().add(a, b, c, other).add(a, c, b, other).double_sided(), (sides{false, false}));
  }
}

TEST(opposite_pairs, a_double_sided_leaf_changes_nothing_for_others) {
  EXPECT_EQ(leaves().add(a, b, c).add(a, c, b, alpha_mode::mask, true).double_sided(), (sides{false, true}));
}

TEST(opposite_pairs, what_is_absent_is_nobodys_back) {
  leaves left_out;
  left_out.add(a, b, c).add(a, c, b);
  left_out.last().tags.never = true;
  EXPECT_EQ(left_out.double_sided(), (sides{false, false}));
}

TEST(opposite_pairs, backs_are_found_in_world_space) {
  leaves moved;
  moved.add(a, b, c).add({-5, 0, 0}, {-5, 1, 0}, {-4, 0, 0}).add({-5, 0, 0}, {-5, 1, 0}, {-4, 0, 0});
  moved.last().to_world[3] = {5, 0, 0, 1};
  EXPECT_EQ(moved.double_sided(), (sides{true, false, true}));
}

TEST(opposite_pairs, many_pairs_are_told_apart) {
  leaves many;
  sides expected;
  for (int i = 0; i < 300; ++i) {
    const auto x = static_cast<float>(i);
    many.add({x, 0, 0}, {x, 1, 0}, {x, 0, 1});
    if (i % 3 == 0) many.add({x, 0, 0}, {x, 0, 1}, {x, 1, 0});
    expected.insert(expected.end(), i % 3 == 0 ? 2 : 1, i % 3 == 0);
  }
  EXPECT_EQ(many.double_sided(), expected);
}

}  // namespace
}  // namespace sightcell::scene
