#include "trace/viewpoint_region.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace sightcell::bake {
namespace {

using kind = viewpoint_region::kind;
const box hall{{0, 0, 0}, {4, 2, 4}};

// The corner of 1 x 1 x 1 m at the lowest coordinates: splits of x, z, x, y, z.
viewpoint_region lowest_corner() {
  return viewpoint_region::build(hall, [](const box& node, int) {
    if (node.min.x >= 1 || node.min.y >= 1 || node.min.z >= 1) return kind::outside;
    return node.max.x <= 1 && node.max.y <= 1 && node.max.z <= 1 ? kind::inside : kind::split;
  });
}

bool in(const box& b, const glm::vec3& p) {
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] < b.min[axis] || p[axis] > b.max[axis]) return false;
  return true;
}

TEST(viewpoint_region, a_box_is_the_whole_of_itself) {
  const viewpoint_region all = hall;
  EXPECT_TRUE(all.is_whole());
  EXPECT_EQ(all.share(), 1.0);
  EXPECT_TRUE(all.encode().empty());
  EXPECT_TRUE(all.contains({3.9f, 1.9f, 3.9f}));
  ASSERT_EQ(all.parts().size(), 1u);
  EXPECT_TRUE(all.rest().empty());
  random_stream one(1, 2, purpose::viewpoints), other(1, 2, purpose::viewpoints);
  EXPECT_EQ(all.draw(one), other.in_box(hall.min, hall.max)) << "the numbers of a box are those of a plain draw";
}

TEST(viewpoint_region, leaves_fill_the_box_without_overlap) {
  const viewpoint_region part = lowest_corner();
  EXPECT_NEAR(part.share(), 1.0 / 32.0, 1e-12);
  ASSERT_EQ(part.parts().size(), 1u);
  EXPECT_EQ(part.parts().front().max, glm::vec3(1.0f));
  double volume = 0.0;
  for (const std::vector<box>& leaves : {part.parts(), part.rest()})
    for (const box& leaf : leaves) {
      const glm::vec3 size = leaf.max - leaf.min;
      volume += static_cast<double>(size.x) * size.y * size.z;
    }
  EXPECT_NEAR(volume, 32.0, 1e-4);
}

TEST(viewpoint_region, points_are_drawn_inside_and_outside) {
  const viewpoint_region part = lowest_corner();
  random_stream random(1, 2, purpose::viewpoints);
  std::array<int, 8> octants{};
  for (int i = 0; i < 4000; ++i) {
    const glm::vec3 p = part.draw(random);
    EXPECT_TRUE(in(part.parts().front(), p));
    EXPECT_TRUE(part.contains(p));
    ++octants[(p.x < 0.5f ? 1u : 0u) + (p.y < 0.5f ? 2u : 0u) + (p.z < 0.5f ? 4u : 0u)];
    EXPECT_FALSE(part.contains(part.draw_outside(random)));
  }
  for (const int count : octants) EXPECT_NEAR(count, 500, 120);
}

// Leaves of different sizes get points in proportion to their volume.
TEST(viewpoint_region, density_is_the_same_in_all_leaves) {
  const viewpoint_region part = viewpoint_region::build(hall, [](const box& node, int depth) {
    if (depth == 1 && node.min.x == 0.0f) return kind::inside;  // half of the box
    if (depth == 4) return node.min == glm::vec3(2, 0, 0) ? kind::inside : kind::outside;
    return kind::split;
  });
  ASSERT_EQ(part.parts().size(), 2u);
  EXPECT_NEAR(part.share(), 0.5 + 1.0 / 16.0, 1e-12);
  random_stream random(3, 4, purpose::viewpoints);
  int small = 0;
  for (int i = 0; i < 9000; ++i) small += part.draw(random).x >= 2.0f ? 1 : 0;
  EXPECT_NEAR(small, 1000, 150);
}

TEST(viewpoint_region, bytes_come_back_as_the_same_region) {
  const viewpoint_region part = lowest_corner();
  const std::vector<std::uint8_t> bytes = part.encode();
  EXPECT_EQ(bytes.size(), 3u) << "11 nodes of two bits";
  const auto again = viewpoint_region::decode(hall, bytes);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->encode(), bytes);
  EXPECT_EQ(again->share(), part.share());
  EXPECT_TRUE(viewpoint_region::decode(hall, {})->is_whole());
}

TEST(viewpoint_region, other_bytes_are_rejected) {
  const std::vector<std::uint8_t> good = lowest_corner().encode();
  for (std::size_t cut = 1; cut < good.size(); ++cut)
    EXPECT_FALSE(viewpoint_region::decode(hall, std::span(good).first(cut))) << "cut after " << cut;
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  EXPECT_FALSE(viewpoint_region::decode(hall, longer));
  const auto one = [](std::uint8_t byte) { return viewpoint_region::decode(hall, std::array{byte}); };
  EXPECT_FALSE(one(0)) << "nothing inside";
  EXPECT_FALSE(one(1)) << "the whole box has no bytes";
  EXPECT_FALSE(one(3)) << "no kind of node";
  EXPECT_FALSE(one(0b000010)) << "split, both halves outside";
  EXPECT_TRUE(one(0b000110)) << "split, the lower half inside";
  EXPECT_FALSE(one(0b01000110)) << "bits after the last node";
  // Splits without an end are rejected at the greatest depth, whatever the length.
  EXPECT_FALSE(viewpoint_region::decode(hall, std::vector<std::uint8_t>(1000, 0b10101010)));
  // Every pair of bytes is rejected or comes back as it was.
  for (unsigned bits = 0; bits < 65536; bits += 7) {
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
    const auto read = viewpoint_region::decode(hall, bytes);
    if (!read) continue;
    EXPECT_EQ(read->encode(), std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  }
}

TEST(viewpoint_region, contains_agrees_with_the_leaves) {
  const viewpoint_region part = viewpoint_region::build(hall, [](const box& node, int depth) {
    if (depth < 7) return kind::split;
    return static_cast<int>(16 * (node.min.x + 3 * node.min.y + 5 * node.min.z)) % 3 == 0 ? kind::inside
                                                                                          : kind::outside;
  });
  random_stream random(5, 6, purpose::viewpoints);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 p = random.in_box(hall.min, hall.max);
    bool inside = false;
    for (const box& leaf : part.parts()) {
      bool here = true;
      for (int axis = 0; axis < 3; ++axis) here = here && p[axis] >= leaf.min[axis] && p[axis] < leaf.max[axis];
      inside = inside || here;
    }
    EXPECT_EQ(part.contains(p), inside);
  }
}

}  // namespace
}  // namespace sightcell::bake
