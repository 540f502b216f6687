#include "bench/frames/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace sightcell::bench {
namespace {

// So that rounding never takes away a box that touches a plane: of the numbers that a test adds up.
constexpr float rounding = 4e-6f;

struct bounds {
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = std::min(min[axis], p[axis]);
      max[axis] = std::max(max[axis], p[axis]);
    }
  }
};

bool is_finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

class splitter {
 public:
  splitter(const baked_world& world, std::uint32_t most, cluster_set& out) : world_(world), most_(most), out_(out) {
    middles_.resize(world.polygons());
    for (std::uint32_t p = 0; p < world.polygons(); ++p) {
      const glm::vec3 middle = (corner(p, 0) + corner(p, 1) + corner(p, 2)) / 3.0f;
      middles_[p] = is_finite(middle) ? middle : glm::vec3(0.0f);  // not a number cannot be sorted
    }
  }

  void split(std::span<std::uint32_t> polygons) {
    if (polygons.size() <= most_) return close(polygons);
    bounds around;
    for (const std::uint32_t p : polygons) around.add(middles_[p]);
    const glm::vec3 size = around.max - around.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t clusters = (polygons.size() + most_ - 1) / most_;
    const std::size_t half = clusters / 2 * most_;
    std::nth_element(polygons.begin(), polygons.begin() + static_cast<std::ptrdiff_t>(half), polygons.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return middles_[a][axis] != middles_[b][axis] ? middles_[a][axis] < middles_[b][axis] : a < b;
                     });
    split(polygons.first(half));
    split(polygons.subspan(half));
  }

 private:
  const glm::vec3& corner(std::uint32_t polygon, std::uint32_t k) const {
    return world_.geometry.positions[world_.stored_corners[3 * std::size_t{polygon} + k]];
  }

  void close(std::span<std::uint32_t> polygons) {
    std::sort(polygons.begin(), polygons.end(), [&](std::uint32_t a, std::uint32_t b) {
      return world_.source_of_stored[a] < world_.source_of_stored[b];
    });
    bounds around;
    for (const std::uint32_t p : polygons) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (is_finite(corner(p, k))) around.add(corner(p, k));
      }
    }
    out_.boxes.add(around.min, around.max);
    out_.stored.insert(out_.stored.end(), polygons.begin(), polygons.end());
    out_.begin.push_back(static_cast<std::uint32_t>(out_.stored.size()));
  }

  const baked_world& world_;
  std::uint32_t most_;
  cluster_set& out_;
  std::vector<glm::vec3> middles_;
};

}  // namespace

void box_lanes::clear() {
  lanes_.clear();
  size_ = 0;
}

void box_lanes::add(const glm::vec3& min, const glm::vec3& max) {
  if (size_ % width == 0) lanes_.emplace_back();
  lane& to = lanes_.back();
  for (int axis = 0; axis < 3; ++axis) {
    to.middle[axis][size_ % width] = 0.5f * (min[axis] + max[axis]);
    to.half[axis][size_ % width] = 0.5f * (max[axis] - min[axis]);
  }
  ++size_;
}

void box_lanes::add(const box_lanes& from, std::size_t i) {
  if (size_ % width == 0) lanes_.emplace_back();
  lane& to = lanes_.back();
  const lane& of = from.lanes_[i / width];
  for (int axis = 0; axis < 3; ++axis) {
    to.middle[axis][size_ % width] = of.middle[axis][i % width];
    to.half[axis][size_ % width] = of.half[axis][i % width];
  }
  ++size_;
}

void box_lanes::find_visible(const frustum& f, std::vector<std::uint8_t>& visible) const {
  visible.resize(lanes_.size() * width);
  float most = 0.0f;
  for (int axis = 0; axis < 3; ++axis) most = std::max(most, std::abs(f.eye[axis]));
  for (std::size_t l = 0; l < lanes_.size(); ++l) {
    const lane& boxes = lanes_[l];
    float outside[width] = {};
    for (const glm::vec3& n : f.inward) {
      for (std::size_t i = 0; i < width; ++i) {
        const float x = boxes.middle[0][i] - f.eye.x, y = boxes.middle[1][i] - f.eye.y,
                    z = boxes.middle[2][i] - f.eye.z;
        const float reach =
            std::abs(n.x) * boxes.half[0][i] + std::abs(n.y) * boxes.half[1][i] + std::abs(n.z) * boxes.half[2][i];
        const float slack = rounding * (most + std::abs(x) + std::abs(y) + std::abs(z) + reach);
        outside[i] = std::max(outside[i], -(n.x * x + n.y * y + n.z * z) - reach - slack);
      }
    }
    for (std::size_t i = 0; i < width; ++i) visible[l * width + i] = outside[i] > 0.0f ? 0 : 1;
  }
  visible.resize(size_);
}

cluster_set::cluster_set(const baked_world& world, std::uint32_t most) {
  begin.push_back(0);
  splitter work(world, most, *this);
  std::vector<std::uint32_t> polygons;
  for (const surface_group& g : world.groups) {
    group_begin.push_back(count());
    polygons.resize(g.count);
    std::iota(polygons.begin(), polygons.end(), g.first);
    if (!polygons.empty()) work.split(polygons);
  }
  group_begin.push_back(count());
}

}  // namespace sightcell::bench
