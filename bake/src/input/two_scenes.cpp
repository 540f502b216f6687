#include "input/two_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "trace/duplicates.h"

namespace sightcell::bake {
namespace {

bool is_empty(const scene::world_geometry& geometry) {
  return std::all_of(geometry.kinds.begin(), geometry.kinds.end(),
                     [](const scene::polygon_kind& kind) { return kind.absent; });
}

// Makes polygons from `first` on absent if they duplicate an earlier one exactly.
void drop_duplicates(scene::world_geometry& geometry, std::uint32_t first, bool all_double_sided) {
  const duplicate_classes duplicates(geometry, all_double_sided);
  const auto count = static_cast<std::uint32_t>(geometry.kinds.size());
  bool any = false;
  for (std::uint32_t polygon = first; polygon < count; ++polygon) {
    const auto same = duplicates.class_of(polygon);
    if (same.empty() || same.front() >= first) continue;
    geometry.kinds[polygon].absent = true;
    geometry.kinds[polygon].always = geometry.kinds[polygon].alpha_tested = false;
    any = true;
  }
  if (!any) return;
  std::erase_if(geometry.masked, [&](const scene::masked_polygon& m) { return geometry.kinds[m.id].absent; });
}

}  // namespace

std::string fingerprint_text(const scene::scene& s) {
  return fmt::format("{:02x}", fmt::join(s.fingerprint, ""));
}

std::optional<std::string> stored_cells_from(std::string_view settings) {
  const auto text = scene::parse_json(settings, false);
  if (!text.is_object()) return std::nullopt;
  const auto found = text.find(cells_from_member);
  if (found == text.end() || !found->is_string()) return std::nullopt;
  return found->get<std::string>();
}

void refuse_colors_of_two_scenes(const char* option) {
  throw error(error_kind::wrong_use, "settings.two-scenes", option,
              "needs colors, which a bake with --cells-from does not have",
              "choose another sampler and --metric pixel or view");
}

void append(scene::world_geometry& geometry, scene::world_geometry&& other, bool all_double_sided,
            const std::string& other_name) {
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
  other = {};
  drop_duplicates(geometry, first, all_double_sided);
}

}  // namespace sightcell::bake
