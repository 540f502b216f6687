#include "search/dilation.h"

#include <algorithm>

#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// Returns whether the polygon faces some point of the box. A box is behind a plane if its eight corners are.
bool faces_box(const ray_scene& rays, std::uint32_t polygon, const box& where) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 eye{(corner & 1) != 0 ? where.max.x : where.min.x, (corner & 2) != 0 ? where.max.y : where.min.y,
                        (corner & 4) != 0 ? where.max.z : where.min.z};
    if (faces(rays, polygon, eye)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::uint32_t> ring_of(const ray_scene& rays, const vertex_neighbors& sharing, safety_ring how,
                                   const box& grown, std::span<const std::uint32_t> set) {
  std::vector<std::uint32_t> ring, beside;
  if (how == safety_ring::none) return ring;
  // A polygon is visited once for each vertex that it shares, so twice if it shares an edge.
  const std::size_t shared = how == safety_ring::edge ? 2 : 1;
  for (const std::uint32_t member : set) {
    beside.clear();
    sharing.for_each(member, [&](std::uint32_t neighbor) { beside.push_back(neighbor); });
    std::sort(beside.begin(), beside.end());
    for (std::size_t first = 0, end = 0; first < beside.size(); first = end) {
      while (end < beside.size() && beside[end] == beside[first]) ++end;
      if (end - first >= shared && !std::binary_search(set.begin(), set.end(), beside[first]))
        ring.push_back(beside[first]);
    }
  }
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  std::erase_if(ring, [&](std::uint32_t polygon) { return !faces_box(rays, polygon, grown); });
  return ring;
}

}  // namespace sightcell::bake
