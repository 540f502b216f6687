#include "search/vertex_neighbors.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

namespace sightcell::bake {
namespace {

// Welds by sorting, so that the numbers depend on positions alone. -0 and +0 are equal, as in comparisons.
std::vector<std::uint32_t> weld(const std::vector<glm::vec3>& positions, std::uint32_t& count) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  // A NaN would break the strict weak ordering. Such vertices belong to absent polygons only and are sorted first.
  const auto key = [&](std::uint32_t i) {
    const glm::vec3& p = positions[i];
    const bool finite = p.x == p.x && p.y == p.y && p.z == p.z;
    return finite ? std::tuple{1, p.x, p.y, p.z} : std::tuple{0, 0.0f, 0.0f, 0.0f};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint32_t> welded(positions.size());
  count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++count;
    welded[order[i]] = count;
  }
  if (!order.empty()) ++count;
  return welded;
}

}  // namespace

vertex_neighbors::vertex_neighbors(const scene::world_geometry& geometry) {
  std::uint32_t vertices = 0;
  const std::vector<std::uint32_t> welded = weld(geometry.positions, vertices);
  corners_.assign(geometry.indices.size(), scene::no_index);
  starts_.assign(std::size_t{vertices} + 1, 0);
  for (std::size_t i = 0; i < geometry.indices.size(); ++i) {
    if (geometry.kinds[i / 3].absent) continue;
    corners_[i] = welded[geometry.indices[i]];
    ++starts_[corners_[i] + 1];
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  polygons_.resize(starts_.back());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < corners_.size(); ++i)
    if (corners_[i] != scene::no_index) polygons_[next[corners_[i]]++] = static_cast<std::uint32_t>(i / 3);
}

}  // namespace sightcell::bake
