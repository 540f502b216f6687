#include "input/two_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "input/joined_geometry.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "trace/duplicates.h"

namespace sightcell::bake {
namespace {

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
  geometry.opacity = scene::make_opacity_maps(geometry.masked, geometry.masks);
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
  const auto first = static_cast<std::uint32_t>(geometry.kinds.size());
  join(geometry, std::move(other), other_name);
  drop_duplicates(geometry, first, all_double_sided);
}

}  // namespace sightcell::bake
