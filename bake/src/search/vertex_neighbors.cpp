#include "search/vertex_neighbors.h"

#include <tbb/parallel_sort.h>

#include <array>
#include <bit>
#include <compare>
#include <utility>

namespace sightcell::bake {
namespace {

struct placed_vertex {
  std::array<std::uint32_t, 3> position;
  std::uint32_t number;
  auto operator<=>(const placed_vertex&) const = default;
};

// Maps finite numbers to integers of the same order and above 0. -0 and +0 are equal, as in comparisons.
std::uint32_t ordered(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

// Welds by sorting, so that the numbers depend on positions alone.
// Vertices with a NaN belong to absent polygons only. They are welded together, as the first.
std::vector<std::uint32_t> weld(const std::vector<glm::vec3>& positions, std::uint32_t& count) {
  std::vector<placed_vertex> order(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const glm::vec3& p = positions[i];
    order[i] = {{0, 0, 0}, i};
    if (p.x == p.x && p.y == p.y && p.z == p.z) order[i].position = {ordered(p.x), ordered(p.y), ordered(p.z)};
  }
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<std::uint32_t> welded(positions.size());
  count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && order[i].position != order[i - 1].position) ++count;
    welded[order[i].number] = count;
  }
  if (!order.empty()) ++count;
  return welded;
}

}  // namespace

vertex_neighbors::vertex_neighbors(const scene::world_geometry& geometry) {
  std::uint32_t vertices = 0;
  const std::vector<std::uint32_t> welded = weld(geometry.positions, vertices);
  const auto each_corner = [&](const auto& visit) {
    for (std::size_t i = 0; i < geometry.indices.size(); ++i)
      if (!geometry.kinds[i / 3].absent) visit(i, welded[geometry.indices[i]]);
  };
  std::vector<std::uint32_t> starts(vertices, 0);
  each_corner([&](std::size_t, std::uint32_t vertex) { ++starts[vertex]; });
  std::uint32_t size = 0;
  for (std::uint32_t& start : starts) size += 1 + std::exchange(start, size);
  lists_.assign(size, 0);
  lists_of_.assign(geometry.indices.size(), scene::no_index);
  each_corner([&](std::size_t corner, std::uint32_t vertex) {
    lists_of_[corner] = starts[vertex];
    std::uint32_t* list = lists_.data() + starts[vertex];
    list[++list[0]] = static_cast<std::uint32_t>(corner / 3);
  });
}

}  // namespace sightcell::bake
