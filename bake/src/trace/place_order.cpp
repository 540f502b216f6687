#include "trace/place_order.h"

#include <tbb/parallel_sort.h>

#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <glm/vec3.hpp>

namespace sightcell::bake {
namespace {

// All coordinates of a polygon, as bits: an order of any values, NaN included.
using corner_bits = std::array<std::uint32_t, 9>;

corner_bits bits_of(const scene::world_geometry& world, std::uint32_t polygon) {
  corner_bits bits{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3& corner = world.positions[world.indices[3 * std::size_t{polygon} + k]];
    bits[3 * k] = std::bit_cast<std::uint32_t>(corner.x);
    bits[3 * k + 1] = std::bit_cast<std::uint32_t>(corner.y);
    bits[3 * k + 2] = std::bit_cast<std::uint32_t>(corner.z);
  }
  return bits;
}

// A polygon and the first two of its coordinates, which decide nearly all comparisons.
struct placed_polygon {
  std::uint64_t first = 0;
  std::uint32_t id = 0;
};

}  // namespace

void sort_by_place(const scene::world_geometry& world, std::vector<std::uint32_t>& polygons) {
  std::vector<placed_polygon> placed(polygons.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const glm::vec3& corner = world.positions[world.indices[3 * std::size_t{polygons[i]}]];
    placed[i].first =
        std::uint64_t{std::bit_cast<std::uint32_t>(corner.x)} << 32 | std::bit_cast<std::uint32_t>(corner.y);
    placed[i].id = polygons[i];
  }
  tbb::parallel_sort(placed.begin(), placed.end(), [&](const placed_polygon& a, const placed_polygon& b) {
    if (a.first != b.first) return a.first < b.first;
    const corner_bits of_a = bits_of(world, a.id), of_b = bits_of(world, b.id);
    return of_a != of_b ? of_a < of_b : a.id < b.id;
  });
  for (std::size_t i = 0; i < placed.size(); ++i) polygons[i] = placed[i].id;
}

}  // namespace sightcell::bake
