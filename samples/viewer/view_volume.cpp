#include "view_volume.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace viewer {
namespace {

constexpr std::uint32_t block_size = 128;  // polygons

}  // namespace

void add_box(std::vector<segment>& lines, const glm::vec3& min, const glm::vec3& max, const glm::vec4& color) {
  const auto corner = [&](unsigned bits) {
    return glm::vec3((bits & 1u) != 0 ? max.x : min.x, (bits & 2u) != 0 ? max.y : min.y,
                     (bits & 4u) != 0 ? max.z : min.z);
  };
  for (unsigned bits = 0; bits < 8; ++bits) {
    for (const unsigned axis : {1u, 2u, 4u}) {
      if ((bits & axis) == 0) lines.push_back({corner(bits), corner(bits | axis), color});
    }
  }
}

view_volume::view_volume(const fly_camera& camera, float aspect) : eye(camera.eye) {
  const glm::vec3 forward = camera.forward(), right = camera.right(), up = glm::cross(right, forward);
  const float half_height = std::tan(0.5f * camera.vertical_fov), half_width = half_height * aspect;
  normals = {glm::normalize(half_width * forward + right), glm::normalize(half_width * forward - right),
             glm::normalize(half_height * forward + up), glm::normalize(half_height * forward - up)};
}

bool view_volume::touches(const glm::vec3& min, const glm::vec3& max) const {
  const glm::vec3 center = 0.5f * (min + max) - eye, half = 0.5f * (max - min);
  return std::all_of(normals.begin(), normals.end(),
                     [&](const glm::vec3& n) { return glm::dot(n, center) + glm::dot(glm::abs(n), half) >= -1e-3f; });
}

void add_frustum(std::vector<segment>& lines, const fly_camera& camera, float aspect, float distance,
                 const glm::vec4& color) {
  const glm::vec3 forward = camera.forward(), right = camera.right(), up = glm::cross(right, forward);
  const float half_height = std::tan(0.5f * camera.vertical_fov), half_width = half_height * aspect;
  std::array<glm::vec3, 4> far_corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const float x = i == 0 || i == 3 ? -1.0f : 1.0f, y = i < 2 ? -1.0f : 1.0f;
    far_corners[i] = camera.eye + distance * (forward + x * half_width * right + y * half_height * up);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    lines.push_back({camera.eye, far_corners[i], color});
    lines.push_back({far_corners[i], far_corners[(i + 1) % 4], color});
  }
}

polygon_blocks::polygon_blocks(std::span<const sightcell_draw> draws, std::span<const glm::vec3> positions,
                               std::span<const std::uint32_t> stored_indices) {
  for (const sightcell_draw& d : draws) {
    first_of_draw_.push_back(static_cast<std::uint32_t>(blocks_.size()));
    for (std::uint32_t at = 0; at < d.polygon_count; at += block_size) {
      block b{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
      const std::size_t begin = 3 * (std::size_t{d.first_stored} + at);
      const std::size_t end = begin + 3 * std::size_t{std::min(block_size, d.polygon_count - at)};
      for (std::size_t i = begin; i < end; ++i) {
        b.min = glm::min(b.min, positions[stored_indices[i]]);
        b.max = glm::max(b.max, positions[stored_indices[i]]);
      }
      blocks_.push_back(b);
    }
  }
}

void polygon_blocks::clip(std::span<const list_part> parts, const view_volume& volume,
                          std::vector<list_part>& out) const {
  out.clear();
  std::size_t tested = blocks_.size();
  bool touched = false;
  for (const list_part& part : parts) {
    for (std::uint32_t done = 0; done < part.range.count;) {
      const std::uint32_t first = part.range.first + done;
      const std::uint32_t count = std::min(block_size - first % block_size, part.range.count - done);
      const std::size_t number = first_of_draw_[part.range.draw] + first / block_size;
      if (number != tested) {
        tested = number;
        touched = volume.touches(blocks_[number].min, blocks_[number].max);
      }
      if (touched) out.push_back({{part.range.draw, first, count}, part.at + done});
      done += count;
    }
  }
}

}  // namespace viewer
