#include "verify/each_cell.h"

namespace sightcell::bake {

void each_cell(const verified_file& opened, const verify_settings& how, const verify_progress& on_progress,
               const std::function<void(std::uint32_t cell, std::uint64_t rays)>& visit) {
  const std::uint32_t stored = opened.file().cell_count();
  const std::uint32_t chosen = how.cells == 0 ? stored : std::min(how.cells, stored);
  const std::uint64_t rays_each = std::max<std::uint64_t>((how.rays + chosen - 1) / std::max(chosen, 1u), 1);
  for (std::uint32_t i = 0; i < chosen; ++i) {
    visit(static_cast<std::uint32_t>(std::uint64_t{i} * stored / chosen), rays_each);
    if (on_progress) on_progress(i + 1, chosen);
  }
}

std::optional<passed_polygon> first_wrong(const sight& seen,
                                          const std::function<bool(std::uint32_t polygon, float distance)>& right) {
  if (seen.front != no_polygon && !right(seen.front, seen.distance)) return passed_polygon{seen.front, seen.distance};
  for (const passed_polygon& passed : seen.before)
    if (!right(passed.polygon, passed.distance)) return passed;
  return std::nullopt;
}

bool lacks_polygons(const verified_file& opened, const sight_line& line, const sight& seen,
                    std::span<const std::uint8_t> in_set) {
  const ray_scene& rays = opened.rays();
  const auto right = [&](std::uint32_t polygon, float distance) {
    if (in_set[polygon] != 0) return true;
    if (rays.through_gap(line.eye, line.direction, distance, opened.rules().smallest_gap)) return true;
    std::vector<std::uint32_t> same;
    rays.coincident(line.eye, line.direction, distance, same);
    return std::any_of(same.begin(), same.end(), [&](std::uint32_t one) { return in_set[one] != 0; });
  };
  return first_wrong(seen, right).has_value();
}

}  // namespace sightcell::bake
