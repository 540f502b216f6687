#include "casters/polygon_shadows.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t polygons_per_part = 4096, polygons_per_question = 64 * polygons_per_part;

// Fills the elements from `first` to before `end`.
void find_receivers(const ray_scene& rays, std::size_t first, std::size_t end, polygon_shadows& shadows) {
  thread_local std::vector<sight_line> lines;
  thread_local std::vector<std::uint32_t> polygons;
  thread_local std::vector<sight> seen;
  lines.clear(), polygons.clear();
  for (std::size_t i = first; i < end; ++i) {
    const scene::polygon_kind kind = rays.geometry().kinds[i];
    if (kind.absent || kind.alpha == scene::alpha_mode::blend) continue;
    const auto polygon = static_cast<std::uint32_t>(i);
    for (std::size_t point = 0; point < shadow_points; ++point)
      lines.push_back(
          {shadow_point(rays.geometry(), polygon, point) - beside_polygon * shadows.to_light, -shadows.to_light});
    polygons.push_back(polygon);
  }
  seen.resize(lines.size());
  rays.trace(lines, seen);
  for (std::size_t i = 0; i < lines.size(); ++i)
    shadows.receivers[shadow_points * polygons[i / shadow_points] + i % shadow_points] = seen[i].front;
}

}  // namespace

glm::vec3 shadow_point(const scene::world_geometry& geometry, std::uint32_t polygon, std::size_t i) {
  constexpr std::array<std::array<float, 3>, shadow_points> weights{
      {{1.0f / 3, 1.0f / 3, 1.0f / 3}, {0.8f, 0.1f, 0.1f}, {0.1f, 0.8f, 0.1f}, {0.1f, 0.1f, 0.8f}}};
  const triangle t = corners_of(geometry, polygon);
  return t[0] * weights[i][0] + t[1] * weights[i][1] + t[2] * weights[i][2];
}

polygon_shadows shadows_of_polygons(const ray_scene& rays, const glm::vec3& to_light,
                                    const std::function<bool()>& keep_going) {
  const std::size_t polygons = rays.geometry().kinds.size();
  polygon_shadows shadows{to_light, std::vector<std::uint32_t>(shadow_points * polygons, no_polygon)};
  for (std::size_t first = 0; first < polygons && keep_going(); first += polygons_per_question) {
    const std::size_t end = std::min(first + polygons_per_question, polygons);
    tbb::parallel_for(std::size_t{0}, (end - first + polygons_per_part - 1) / polygons_per_part, [&](std::size_t part) {
      const std::size_t from = first + part * polygons_per_part;
      find_receivers(rays, from, std::min(from + polygons_per_part, end), shadows);
    });
  }
  return shadows;
}

}  // namespace sightcell::bake
