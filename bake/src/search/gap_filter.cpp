#include "search/gap_filter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "hemicube/hemicube_faces.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

// Returns the distance along a line to the plane of a triangle. The center of a pixel is on the triangle except for
// rounding, so the plane is enough. Not finite or not positive if the plane is seen edge-on.
float distance_to_plane(const triangle& t, const glm::vec3& eye, const glm::vec3& direction) {
  const glm::dvec3 a(t[0]);
  const glm::dvec3 normal = glm::cross(glm::dvec3(t[1]) - a, glm::dvec3(t[2]) - a);
  return static_cast<float>(glm::dot(normal, a - glm::dvec3(eye)) / glm::dot(normal, glm::dvec3(direction)));
}

// A polygon that is not in the set, in one of the views.
struct sighting {
  seen_polygon* seen;
  std::uint32_t view;
};

}  // namespace

void gap_filter::render(std::span<const pose> poses, std::span<hemicube_view> views) {
  behind_.render(poses, views);
  if (!(smallest_gap_ > 0.0f)) return;
  std::vector<sighting> found;
  for (std::uint32_t view = 0; view < views.size(); ++view)
    for (seen_polygon& seen : views[view].seen)
      if (!set_.contains(seen.id)) found.push_back({&seen, view});
  // Groups the sightings of a polygon, in the order of the views.
  std::sort(found.begin(), found.end(), [](const sighting& a, const sighting& b) {
    return a.seen->id != b.seen->id ? a.seen->id < b.seen->id : a.view < b.view;
  });
  std::atomic<bool> any = false;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size(), 64), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      // Processed with the first sighting of its polygon.
      if (i > 0 && found[i - 1].seen->id == found[i].seen->id) continue;
      for (std::size_t k = i; k < found.size() && found[k].seen->id == found[i].seen->id; ++k) {
        seen_polygon& seen = *found[k].seen;
        if (seen.pixels > 4 * resolution() || !through_gap(poses[found[k].view], seen)) break;
        seen.pixels = 0;  // marks the entry for removal below
        any = true;
      }
    }
  });
  if (!any) return;
  for (hemicube_view& view : views) std::erase_if(view.seen, [](const seen_polygon& seen) { return seen.pixels == 0; });
}

bool gap_filter::through_gap(const pose& where, const seen_polygon& seen) const {
  const glm::vec3 direction = pixel_direction(where, resolution(), seen.pixel);
  const float distance = distance_to_plane(corners_of(rays_.geometry(), seen.id), where.eye, direction);
  return std::isfinite(distance) && distance > 0.0f && rays_.through_gap(where.eye, direction, distance, smallest_gap_);
}

}  // namespace sightcell::bake
