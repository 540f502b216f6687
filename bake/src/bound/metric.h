#pragma once
// What the error is that fresh rays measure: of which directions, and which wrong rays count as a miss.
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

// What a wrong ray lacks: places of which the set has nothing.
struct lacking_surfaces {
  std::vector<std::uint32_t> polygons;  // all that lie in these places (rule 2)
  float nearest = std::numeric_limits<float>::infinity();
};

// Independent rays that count as a miss with a probability each, the mean of which is the error: so misses among them
// are binomial, and the bound of Clopper and Pearson is exact whatever the metric.
class error_metric {
 public:
  // The pixel error: all directions, and every wrong ray counts.
  constexpr error_metric() = default;
  // how: validated. References and colors must outlive the metric; colors: of color, which cannot do without.
  error_metric(const metric_settings& how, const ray_scene& rays, const surface_colors* colors);

  // Uniform on the sphere, or on the band of it that pictures show.
  glm::vec3 direction(random_stream& random) const {
    return kind_ == metric_kind::view ? in_band(random) : random.on_sphere();
  }

  // Seen from eye, is the polygon so large that it counts when it is missing?
  bool is_large(std::uint32_t polygon, const glm::vec3& eye) const {
    return kind_ != metric_kind::view || covers_enough(polygon, eye);
  }

  // For hints: about how much it adds to the error, for each part of all directions, that a set lacks the polygon that
  // shows along a line. By color one ray tells what else of the set hides there; what hides nothing is left out.
  double weight(std::uint32_t polygon, const sight_line& line,
                const std::function<bool(std::uint32_t)>& contains) const;

  // Does a ray that saw this, and lacks some of it, count as a miss? By view: where any of what it lacks is large. By
  // color: where an independent number, uniform in 0..1 and the next one of random, is below the ray's difference of
  // color: a trial that fails with the difference as its probability, and over all rays with the mean of them.
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
  float lowest_ = -1.0f, highest_ = 1.0f;  // of directions: sines of their elevation
  double least_ = 0.0;                     // sr
};

inline constexpr error_metric pixel_metric;

}  // namespace sightcell::bake
