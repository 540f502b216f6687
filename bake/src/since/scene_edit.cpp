#include "since/scene_edit.h"

#include <algorithm>

namespace sightcell::bake {
namespace {

partners_before partners_of(const kept_records& before, const polygon_edit& edit) {
  partners_before partners{.reach = before.partner_reach, .pairs = {}, .added = edit.added};
  for (const auto& [a, b] : before.partners) {
    const std::uint32_t new_a = edit.new_of[a], new_b = edit.new_of[b];
    if (new_a != polygon_edit::gone && new_b != polygon_edit::gone)
      partners.pairs.emplace_back(std::min(new_a, new_b), std::max(new_a, new_b));
  }
  return partners;
}

}  // namespace

scene_edit::scene_edit(const scene::world_geometry& geometry, const kept_records* before) : now(table_of(geometry)) {
  if (!before) return;
  polygons = edit_between(before->polygons, now);
  partners = partners_of(*before, polygons);
}

}  // namespace sightcell::bake
