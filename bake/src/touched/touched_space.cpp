#include "touched/touched_space.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sightcell::bake {
namespace {

// For rounding, in voxels. Places are computed from doubles, so the error is far below this.
constexpr float rounding = 1.0f / 64.0f;

std::uint64_t bits_between(int first, int last) {
  return (~std::uint64_t{0} >> (63 - last)) & (~std::uint64_t{0} << first);
}

}  // namespace

std::uint32_t touched_space::block_of(std::uint32_t resolution) {
  return resolution >= 512 ? 8 : resolution >= 256 ? 4 : resolution >= 128 ? 2 : 1;
}

touched_space::touched_space(const box& cell, const box& scene) : middle_(0.5f * (cell.min + cell.max)) {
  const glm::vec3 own = cell.max - cell.min;
  half_ = std::max({own.x, own.y, own.z, 1e-3f});
  const glm::vec3 far = glm::max(glm::abs(scene.min - middle_), glm::abs(scene.max - middle_));
  const float needed = std::max({far.x, far.y, far.z});
  while (levels_ < most_levels && half_of(levels_ - 1) < needed) ++levels_;
  rows_.resize(rows_of_level * static_cast<std::size_t>(levels_));
}

void touched_space::add(const touched_space& other) {
  if (other.rows_.size() > rows_.size()) rows_.resize(other.rows_.size());
  levels_ = std::max(levels_, other.levels_);
  for (std::size_t i = 0; i < other.rows_.size(); ++i) rows_[i] |= other.rows_[i];
  escapes_ = escapes_ || other.escapes_;
  faces_.add(other.faces_);
}

float touched_space::half_of(int level) const {
  return std::ldexp(half_, level);
}

void touched_space::mark_line(const glm::vec3& from, const glm::vec3& direction, float length) {
  const glm::dvec3 eye = glm::dvec3(from) - glm::dvec3(middle_), along(direction);
  const double end = static_cast<double>(length);
  double half = static_cast<double>(half_), per_meter = side / (2.0 * half), begin = 0.0;
  const glm::dvec3 inverse = 1.0 / along;  // infinite along an axis that the line does not move on
  for (int level = 0; level < levels_; ++level, half *= 2.0, per_meter *= 0.5) {
    double leaves = end;
    for (int axis = 0; axis < 3; ++axis)
      leaves = std::min(leaves, (std::copysign(half, along[axis]) - eye[axis]) * inverse[axis]);
    if (!(leaves < std::numeric_limits<double>::infinity())) leaves = begin;  // no direction
    if (leaves >= begin) {
      walk(level, (eye + along * begin) * per_meter, (eye + along * leaves) * per_meter);
      begin = leaves;
    }
    if (leaves >= end) return;
  }
  escapes_ = true;
}

// Marks voxels at equal steps of at most one voxel along each axis. So each point of the segment is within half a voxel
// of a marked one on each axis, which meets() adds. first, last: in voxels from the middle. Most voxels are marked
// already by earlier lines; then nothing is written.
void touched_space::walk(int level, const glm::dvec3& first, const glm::dvec3& last) {
  constexpr double fixed = 1 << 20;  // parts of a voxel
  const auto inside = [](const glm::dvec3& place) { return glm::clamp(place + side / 2.0, 0.0, side - 1e-3); };
  const glm::dvec3 from = inside(first), way = inside(last) - from;
  const double longest = std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
  const int whole = static_cast<int>(longest), steps = whole + (longest > whole ? 1 : 0);
  const glm::dvec3 stride = way * (fixed / std::max(steps, 1));
  glm::ivec3 at(from * fixed);
  const glm::ivec3 by(stride);
  std::uint64_t* rows = rows_.data() + rows_of_level * static_cast<std::size_t>(level);
  for (int i = 0; i <= steps; ++i, at += by) {
    std::uint64_t& row = rows[((at.z >> 20) * side + (at.y >> 20)) & (side * side - 1)];
    const std::uint64_t bit = std::uint64_t{1} << ((at.x >> 20) & (side - 1));
    if ((row & bit) == 0) row |= bit;
  }
}

void touched_space::mark_box(const glm::vec3& min, const glm::vec3& max) {
  const glm::vec3 far = glm::max(glm::abs(min - middle_), glm::abs(max - middle_));
  const float needed = std::max({far.x, far.y, far.z});
  int level = 0;
  while (level < levels_ - 1 && half_of(level) < needed) ++level;
  if (half_of(level) < needed) escapes_ = true;
  const float half = half_of(level), width = 2.0f * half / side;
  int first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float low = middle_[axis] - half;
    first[axis] = static_cast<int>(std::clamp(std::floor((min[axis] - low) / width - rounding), 0.0f, side - 1.0f));
    last[axis] = static_cast<int>(std::clamp(std::floor((max[axis] - low) / width + rounding), 0.0f, side - 1.0f));
  }
  std::uint64_t* rows = rows_.data() + rows_of_level * static_cast<std::size_t>(level);
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y) rows[z * side + y] |= bits_between(first[0], last[0]);
}

bool touched_space::meets(const std::array<glm::vec3, 3>& corners, float near) const {
  if (faces_.meets(corners)) return true;
  const box where{glm::min(corners[0], glm::min(corners[1], corners[2])),
                  glm::max(corners[0], glm::max(corners[1], corners[2]))};
  plane cut;
  cut.normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const float length = glm::length(cut.normal);
  cut.normal = length > 0.0f ? cut.normal / length : glm::vec3{0.0f};
  cut.offset = glm::dot(cut.normal, corners[0]);
  return meets(where, near, cut);
}

bool touched_space::meets(const box& where, float near) const {
  return faces_.meets(where) || meets(where, near, {});
}

bool touched_space::meets(const box& where, float near, const plane& cut) const {
  const glm::vec3 far_corner = glm::max(glm::abs(where.min - middle_), glm::abs(where.max - middle_));
  const float far = std::max({far_corner.x, far_corner.y, far_corner.z});
  if (!(far <= half_of(levels_ - 1)) && escapes_) return true;
  for (int level = 0; level < levels_; ++level) {
    const float by = near + (0.5f + rounding) * 2.0f * half_of(level) / side;
    if (meets(level, where, by, cut)) return true;
  }
  return false;
}

bool touched_space::meets(int level, const box& polygon, float by, const plane& cut) const {
  const box where = polygon.grown(by);
  const float half = half_of(level), width = 2.0f * half / side;
  int first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float low = middle_[axis] - half;
    const float from = std::floor((where.min[axis] - low) / width), to = std::floor((where.max[axis] - low) / width);
    if (!(to >= 0.0f && from < static_cast<float>(side))) return false;
    first[axis] = static_cast<int>(std::max(from, 0.0f));
    last[axis] = static_cast<int>(std::min(to, side - 1.0f));
  }
  const std::uint64_t* rows = rows_.data() + rows_of_level * static_cast<std::size_t>(level);
  const std::uint64_t wanted = bits_between(first[0], last[0]);
  const bool has_plane = cut.normal != glm::vec3{0.0f};
  const glm::vec3 size = glm::abs(cut.normal);
  // With half a voxel along the normal, and half a one between the steps of walk().
  const float reach = by + width * (size.x + size.y + size.z);
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y) {
      std::uint64_t found = rows[z * side + y] & wanted;
      if (!has_plane && found != 0) return true;
      for (; found != 0; found &= found - 1) {
        const int x = __builtin_ctzll(found);
        const glm::vec3 voxel{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        const glm::vec3 middle = middle_ - half + (voxel + 0.5f) * width;
        if (std::abs(glm::dot(cut.normal, middle) - cut.offset) <= reach) return true;
      }
    }
  return false;
}

}  // namespace sightcell::bake
