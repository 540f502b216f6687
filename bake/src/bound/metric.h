#pragma once
// The metrics of --metric: which directions verification rays take, and which of their misses count.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "sightcell/bake/settings.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

class surface_colors;

// The surfaces along one ray of which the set has no polygon.
struct lacking_surfaces {
  std::vector<std::uint32_t> polygons;  // all polygons in the same place as these surfaces (rule 2)
  // Meters from the viewpoint to the nearest of them.
  float nearest = std::numeric_limits<float>::infinity();
};

// A definition of the error of a set. Each ray counts as a miss with some probability, and the error is the mean of
// these probabilities. Counted misses of independent rays are therefore binomial, and the Clopper-Pearson bound is
// exact for every metric.
class error_metric {
 public:
  // The metric `pixel`: all directions, every miss counts.
  constexpr error_metric() = default;
  // how: validated settings.
  // rays: must outlive the metric.
  // colors: must outlive the metric. Required by the metric `color`, unused by the others.
  error_metric(const metric_settings& how, const ray_scene& rays, const surface_colors* colors);

  // Returns a random direction: uniform on the sphere, or for `view` on the band of elevations that pictures show.
  glm::vec3 direction(random_stream& random) const {
    return kind_ == metric_kind::view ? in_band(random) : random.on_sphere();
  }

  // Returns whether a missing polygon is large enough to count, as seen from eye. For metrics other than `view` every
  // polygon is.
  bool is_large(std::uint32_t polygon, const glm::vec3& eye) const {
    return kind_ != metric_kind::view || covers_enough(polygon, eye);
  }

  // Returns the approximate error per unit of solid angle (as a fraction of the sphere) if the set lacks the polygon
  // that is visible along a line. It orders candidates and affects no bound. For `color`, one ray finds the occluder of
  // the set behind the polygon; non-occluders are ignored.
  double weight(std::uint32_t polygon, const sight_line& line,
                const std::function<bool(std::uint32_t)>& contains) const;

  // Returns whether a ray that lacks some of what it met counts as a miss.
  // `view`: it does if any of the missing polygons is large. `color`: it does if the next number of random, uniform in
  // [0, 1), is below the difference of color along the ray. Such a trial fails with that difference as its probability,
  // and over all rays with the mean difference.
  // seen: what the ray met.
  // lacking: the part of it that the set lacks.
  bool counts(const sight_line& line, const sight& seen, const lacking_surfaces& lacking,
              const std::function<bool(std::uint32_t)>& contains, random_stream& random) const;

 private:
  glm::vec3 in_band(random_stream& random) const;
  bool covers_enough(std::uint32_t polygon, const glm::vec3& eye) const;
  double color_difference(const sight_line& line, const sight& seen, float from,
                          const std::function<bool(std::uint32_t)>& contains) const;

  metric_kind kind_ = metric_kind::pixel;
  const ray_scene* rays_ = nullptr;
  const surface_colors* colors_ = nullptr;
  float lowest_ = -1.0f, highest_ = 1.0f;  // sines of the lowest and highest elevation
  double least_ = 0.0;                     // smallest solid angle that counts, in sr
};

inline constexpr error_metric pixel_metric;

}  // namespace sightcell::bake
