#include "input/joined_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <iterator>
#include <limits>
#include <utility>

#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

bool is_empty(const scene::world_geometry& geometry) {
  return std::all_of(geometry.kinds.begin(), geometry.kinds.end(),
                     [](const scene::polygon_kind& kind) { return kind.absent; });
}

}  // namespace

void join(scene::world_geometry& geometry, scene::world_geometry&& other, const std::string& other_name) {
  constexpr std::size_t limit = std::numeric_limits<std::uint32_t>::max();
  const std::size_t polygons = geometry.kinds.size() + other.kinds.size();
  const std::size_t vertices = geometry.positions.size() + other.positions.size();
  if (polygons >= limit || vertices >= limit)
    throw error(error_kind::bad_input, "scene.too-large", other_name,
                fmt::format("makes {} polygons and {} vertices with the other scene", polygons, vertices),
                "bake them in parts");
  const auto first = static_cast<std::uint32_t>(geometry.kinds.size());
  const auto first_vertex = static_cast<std::uint32_t>(geometry.positions.size());
  const auto first_mask = static_cast<std::uint32_t>(geometry.masks.size());
  const bool adds = !is_empty(other);
  geometry.positions.insert(geometry.positions.end(), other.positions.begin(), other.positions.end());
  geometry.kinds.insert(geometry.kinds.end(), other.kinds.begin(), other.kinds.end());
  geometry.indices.reserve(geometry.indices.size() + other.indices.size());
  for (const std::uint32_t vertex : other.indices) geometry.indices.push_back(first_vertex + vertex);
  for (scene::masked_polygon& m : other.masked) {
    m.id += first;
    m.mask += first_mask;
    geometry.masked.push_back(m);
  }
  std::move(other.masks.begin(), other.masks.end(), std::back_inserter(geometry.masks));
  std::move(other.warnings.begin(), other.warnings.end(), std::back_inserter(geometry.warnings));
  if (adds) {
    geometry.min = glm::min(geometry.min, other.min);
    geometry.max = glm::max(geometry.max, other.max);
  }
  if (!other.masked.empty()) geometry.opacity = scene::make_opacity_maps(geometry.masked, geometry.masks);
  other = {};
}

}  // namespace sightcell::bake
