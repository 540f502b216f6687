#pragma once
// What the checks of a finished file share: which cells they measure, the random lines of a cell, and which lines show
// what a set lacks.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bound/clopper_pearson.h"
#include "bound/metric.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/random.h"
#include "trace/viewpoints.h"
#include "verify/verified_file.h"

namespace sightcell::bake {

// Calls visit for the cells to measure, in ascending order: all, or how.cells of them, evenly spread.
// visit: called on this thread, with a cell and its share of how.rays, which is at least 1.
void each_cell(const verified_file& opened, const verify_settings& how, const verify_progress& on_progress,
               const std::function<void(std::uint32_t cell, std::uint64_t rays)>& visit);

// Casts the lines of verify() for a cell: from random valid viewpoints in random directions. Each part has 512 lines
// and random numbers of its own, so that the result does not depend on threads.
// rays: how many lines. There are fewer where less than one point in 256 is a valid viewpoint.
// cast: called for each line, from several threads, with the part that it belongs to.
// Returns the parts in order. part_type::rays counts the lines.
template <class part_type>
std::vector<part_type> cast_lines(const verified_file& opened, std::uint64_t seed, std::uint32_t cell,
                                  std::uint64_t rays, const std::invocable<const sight_line&, part_type&> auto& cast) {
  constexpr std::uint64_t rays_of_part = 512, most_tries_per_ray = 256;
  const viewpoint_region region = opened.region(cell);
  std::vector<part_type> parts((rays + rays_of_part - 1) / rays_of_part);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    const std::uint64_t size = std::min(rays_of_part, rays - i * rays_of_part);
    random_stream random(seed, cell, purpose::verify, 0, i);
    std::uint64_t tries = 0;
    const std::vector<glm::vec3> eyes = draw_viewpoints(opened.rays(), region, opened.rules().player_radius, size,
                                                        size * most_tries_per_ray, random, tries);
    parts[i].rays = eyes.size();
    for (const glm::vec3& eye : eyes) cast(sight_line{eye, pixel_metric.direction(random)}, parts[i]);
  });
  return parts;
}

// Returns the first of what is visible along a line that is not right: the front, then what is before it.
// right: whether a polygon at a distance is drawn, or excused.
std::optional<passed_polygon> first_wrong(const sight& seen,
                                          const std::function<bool(std::uint32_t polygon, float distance)>& right);

// Returns whether a line shows a polygon of the scene that a set lacks and that rules 2 and 3 do not excuse.
// seen: what is visible along it in opened.rays().
// in_set: by polygon of the scene, 0 or 1.
bool lacks_polygons(const verified_file& opened, const sight_line& line, const sight& seen,
                    std::span<const std::uint8_t> in_set);

// Fills the share of misses and its bound in the result of a check, and keeps of result.missing the 100 entries with
// the most rays; entries with equally many stay in the order in which they were found.
void finish(auto& result) {
  constexpr std::size_t reported = 100;
  if (result.rays > 0) result.pixel_error = static_cast<double>(result.misses) / static_cast<double>(result.rays);
  result.upper_bound = clopper_pearson_upper(result.misses, result.rays, result.confidence);
  std::stable_sort(result.missing.begin(), result.missing.end(),
                   [](const auto& a, const auto& b) { return a.rays > b.rays; });
  if (result.missing.size() > reported) result.missing.resize(reported);
}

}  // namespace sightcell::bake
