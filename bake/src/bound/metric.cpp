#include "bound/metric.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "hemicube/surface_colors.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

// Returns the sine of the highest elevation in a picture of a camera that is pitched upward by `pitch`.
double highest_sine(double pitch, double half_fov, double aspect) {
  const double top = pitch + half_fov;
  if (top >= 90.0 * degree) return 1.0;
  if (top >= 0.0) return std::sin(top);  // at the middle of the upper border
  // The whole picture is below the horizon: the upper corners are nearest to it.
  const double up = std::tan(half_fov), side = aspect * up;
  return (std::sin(pitch) + up * std::cos(pitch)) / std::sqrt(1.0 + up * up + side * side);
}

// Returns the solid angle of the center pixel in sr: a square in front of the camera.
double pixel_solid_angle(const metric_settings& how) {
  const double half = std::tan(0.5 * how.view_fov * degree) / how.view_height;
  return 4.0 * std::atan(half * half / std::sqrt(1.0 + 2.0 * half * half));
}

// As solid_angle(), but in double precision and from edge vectors. In single precision, triangles smaller than a pixel
// are lost to rounding.
double covered(const triangle& corners, const glm::vec3& eye) {
  const glm::dvec3 a = glm::dvec3(corners[0]) - glm::dvec3(eye), b = glm::dvec3(corners[1]) - glm::dvec3(eye),
                   c = glm::dvec3(corners[2]) - glm::dvec3(eye);
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = std::abs(glm::dot(a, glm::cross(b - a, c - a)));
  return 2.0 * std::atan2(volume, la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la);
}

}  // namespace

error_metric::error_metric(const metric_settings& how, const ray_scene& rays, const surface_colors* colors)
    : kind_(how.kind), rays_(&rays), colors_(colors) {
  if (kind_ != metric_kind::view) return;
  const double half_fov = 0.5 * how.view_fov * degree, aspect = static_cast<double>(how.view_width) / how.view_height;
  highest_ = static_cast<float>(highest_sine(how.view_pitch[1] * degree, half_fov, aspect));
  lowest_ = static_cast<float>(-highest_sine(-how.view_pitch[0] * degree, half_fov, aspect));
  least_ = how.view_least * pixel_solid_angle(how);
}

// As random_stream::on_sphere(). For a uniform point in a disk the squared distance from the center is uniform and
// independent of the angle. Here it decides the height, which is uniform on the sphere by solid angle (Archimedes).
glm::vec3 error_metric::in_band(random_stream& random) const {
  for (;;) {
    const float a = 2.0f * random.uniform() - 1.0f, b = 2.0f * random.uniform() - 1.0f, s = a * a + b * b;
    if (s >= 1.0f || s == 0.0f) continue;
    const float up = lowest_ + (highest_ - lowest_) * s;
    const float around = std::sqrt(std::max((1.0f - up) * (1.0f + up), 0.0f) / s);
    return {a * around, up, b * around};
  }
}

bool error_metric::covers_enough(std::uint32_t polygon, const glm::vec3& eye) const {
  return covered(corners_of(rays_->geometry(), polygon), eye) >= least_;
}

// Returns the largest difference of color along a line between a picture of the scene and one of the set. The opacity
// of non-occluders (glass, a door that may be open) is unknown here. So the function takes all colors that light could
// have, from the nearest missing surface on, in the scene or in the set. Each picture shows a mixture of these colors,
// so the two differ by at most their range. If all surfaces occlude, there are two colors, and the result is their
// difference.
double error_metric::color_difference(const sight_line& line, const sight& seen, float from,
                                      const std::function<bool(std::uint32_t)>& contains) const {
  sight of_set;
  rays_->trace_against_set(line.eye, line.direction, contains, of_set);
  glm::ivec3 low(255), high(0);
  const auto take = [&](std::uint32_t polygon) {
    const glm::ivec3 color(polygon == no_polygon ? surface_colors::sky()
                                                 : colors_->color_of(polygon, line.eye, line.direction));
    low = glm::min(low, color), high = glm::max(high, color);
  };
  const auto take_all = [&](const sight& shown) {
    take(shown.front);
    for (const passed_polygon& passed : shown.before)
      if (passed.distance >= from) take(passed.polygon);
  };
  take_all(seen);
  take_all(of_set);
  const glm::ivec3 range = high - low;
  return (range.x + range.y + range.z) / (3.0 * 255.0);
}

double error_metric::weight(std::uint32_t polygon, const sight_line& line,
                            const std::function<bool(std::uint32_t)>& contains) const {
  if (kind_ == metric_kind::pixel) return 1.0;
  if (kind_ == metric_kind::view) {
    const bool shown = line.direction.y >= lowest_ && line.direction.y <= highest_ && is_large(polygon, line.eye);
    return shown ? 2.0 / static_cast<double>(highest_ - lowest_)
                 : 0.0;  // divided by the share of the sphere that the band has
  }
  const std::uint32_t behind = rays_->front_of_set(line.eye, line.direction, contains);
  const glm::u8vec3 whole = colors_->color_of(polygon, line.eye, line.direction);
  const glm::u8vec3 found =
      behind == no_polygon ? surface_colors::sky() : colors_->color_of(behind, line.eye, line.direction);
  return mean_color_difference({&whole, 1}, {&found, 1});
}

bool error_metric::counts(const sight_line& line, const sight& seen, const lacking_surfaces& lacking,
                          const std::function<bool(std::uint32_t)>& contains, random_stream& random) const {
  if (kind_ == metric_kind::color) {
    const double number = static_cast<double>(random.bits() >> 11) * 0x1p-53;
    return number < color_difference(line, seen, lacking.nearest, contains);
  }
  return std::any_of(lacking.polygons.begin(), lacking.polygons.end(),
                     [&](std::uint32_t polygon) { return is_large(polygon, line.eye); });
}

}  // namespace sightcell::bake
