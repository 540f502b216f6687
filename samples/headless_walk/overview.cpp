#include "overview.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace headless_walk {

namespace picture = sightcell::picture;

picture::camera camera_above(const sightcell::scene::world_geometry& world, const glm::vec3& eye) {
  // As far as shows a few blocks of a town; less where the scene is small.
  constexpr float farthest = 140.0f;
  const float reach = std::min(0.5f * glm::distance(world.min, world.max), farthest);
  // From the outside toward the middle of the scene, and past the cell, which then stands in the foreground.
  const glm::vec3 from_middle = eye - 0.5f * (world.min + world.max);
  const float sideways = glm::length(glm::vec2{from_middle.x, from_middle.z});
  const glm::vec3 outward =
      sideways > 0.01f * reach ? glm::vec3{from_middle.x, 0.0f, from_middle.z} / sideways : glm::vec3{0.6f, 0.0f, 0.8f};
  const glm::vec3 offset = reach * (0.5f * outward + glm::vec3{0.0f, 0.7f, 0.0f});
  return {.eye = eye + offset, .forward = -offset - 0.3f * reach * outward, .vertical_fov = 0.9f};
}

picture::image_rgba side_by_side(const picture::image_rgba& left, const picture::image_rgba& right) {
  constexpr std::size_t channels = 4;
  constexpr std::uint32_t gap = 4;  // pixels, white
  picture::image_rgba both;
  both.width = left.width + gap + right.width;
  both.height = left.height;
  both.pixels.assign(std::size_t{both.width} * both.height * channels, 0xFF);
  for (std::uint32_t y = 0; y < both.height; ++y) {
    const auto row = [&](const picture::image_rgba& from) { return from.pixels.begin() + y * channels * from.width; };
    const auto to = both.pixels.begin() + y * channels * both.width;
    std::copy_n(row(left), channels * left.width, to);
    std::copy_n(row(right), channels * right.width, to + channels * (left.width + gap));
  }
  return both;
}

}  // namespace headless_walk
