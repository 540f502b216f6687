#include "search/boundary_face.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <set>

namespace sightcell::bake {
namespace {

TEST(boundary_face, six_faces_cover_the_box_and_look_out) {
  const glm::vec3 low{1, 2, 3}, high{5, 4, 9};
  std::set<std::array<float, 3>> corners;
  for (const boundary_face& face : faces_of(low, high)) {
    EXPECT_EQ(glm::cross(face.outward, face.up), face.right);
    for (const glm::vec2 uv : {glm::vec2{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
      const glm::vec3 eye = face.at(uv).eye;
      corners.insert({eye.x, eye.y, eye.z});
      const float along = glm::dot(face.outward, eye);
      EXPECT_FLOAT_EQ(along, std::max(glm::dot(face.outward, low), glm::dot(face.outward, high)));
    }
  }
  EXPECT_EQ(corners.size(), 8u);
}

}  // namespace
}  // namespace sightcell::bake
