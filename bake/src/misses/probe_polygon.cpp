#include "misses/probe_polygon.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr float pixel = 1e-6f;  // sr: of 1920 x 1080 pixels at 60 degrees
// A polygon as small as a pixel may be visible past an edge, so more than one ray is needed.
constexpr std::uint64_t fewest_rays = 256, most_rays = 1 << 18;

struct part {
  float size = 0.0f;         // sr
  std::uint64_t number = 0;  // in the order of creation
  triangle corners{};
  bool operator<(const part& other) const {  // largest first, of equals the oldest
    return std::tie(size, other.number) < std::tie(other.size, number);
  }
};

// Returns the edge with the largest angle as seen from the eye.
int widest_edge(const triangle& t, const glm::vec3& eye) {
  int widest = 0;
  float most = -1.0f;
  for (int i = 0; i < 3; ++i) {
    const glm::vec3 &a = t[static_cast<std::size_t>(i)], &b = t[static_cast<std::size_t>((i + 1) % 3)];
    const glm::vec3 along = b - a;
    const float width = glm::dot(along, along) / (glm::length(a - eye) * glm::length(b - eye) + 1e-12f);
    if (width > most) most = width, widest = i;
  }
  return widest;
}

// Returns a point of the part, another one for each number. The centers of the parts would be a grid, which may miss
// narrow straight shapes. Uses a sequence that fills the unit square (Roberts 2018), folded into the triangle.
glm::vec3 point_in(const part& where) {
  const auto number = static_cast<std::uint32_t>(where.number + 1);
  float u = static_cast<float>((number * 3242174889u) >> 8) * 0x1p-24f;
  float v = static_cast<float>((number * 2447445414u) >> 8) * 0x1p-24f;
  if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
  const triangle& t = where.corners;
  return t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
}

class looker {
 public:
  looker(const ray_scene& rays, float smallest_gap, const glm::vec3& eye, std::uint32_t polygon,
         const std::function<bool(std::uint32_t)>& contains)
      : rays_(rays), smallest_gap_(smallest_gap), eye_(eye), polygon_(polygon), contains_(contains) {}

  polygon_sight run() {
    const scene::polygon_kind kind = rays_.geometry().kinds[polygon_];
    if (kind.absent || !faces(rays_, polygon_, eye_)) return result_;
    push(corners_of(rays_.geometry(), polygon_));
    while (!result_.counts && result_.rays < most_rays) {
      const part next = parts_.top();
      if (next.size < pixel && result_.rays >= fewest_rays) break;
      parts_.pop();
      look_at(point_in(next));
      split(next.corners);
    }
    return result_;
  }

 private:
  void push(const triangle& t) { parts_.push({solid_angle(t, eye_), made_++, t}); }

  void split(const triangle& t) {
    const auto i = static_cast<std::size_t>(widest_edge(t, eye_));
    const glm::vec3 &a = t[i], &b = t[(i + 1) % 3], &c = t[(i + 2) % 3], middle = 0.5f * (a + b);
    push({a, middle, c});
    push({middle, b, c});
  }

  void look_at(const glm::vec3& point) {
    ++result_.rays;
    const glm::vec3 toward = point - eye_;
    const float length = glm::length(toward);
    if (!(length > 0.0f)) return;
    const glm::vec3 direction = toward / length;
    rays_.trace(eye_, direction, seen_);
    const std::optional<float> distance = distance_to_polygon(direction, length);
    if (!distance || rays_.through_gap(eye_, direction, *distance, smallest_gap_)) return;
    result_.seen = true;
    rays_.coincident(eye_, direction, *distance, coincident_);
    result_.counts = std::none_of(coincident_.begin(), coincident_.end(), contains_);
  }

  // Returns the distance at which the last ray hit the polygon.
  std::optional<float> distance_to_polygon(const glm::vec3& direction, float length) {
    if (seen_.front == polygon_) return seen_.distance;
    for (const passed_polygon& p : seen_.before)
      if (p.polygon == polygon_) return p.distance;
    // Rule 2: the polygon may coincide with the one that was hit at its distance.
    if (seen_.front == no_polygon) return std::nullopt;
    if (!(std::abs(seen_.distance - length) <= coincidence_reach(seen_.distance))) return std::nullopt;
    rays_.coincident(eye_, direction, seen_.distance, coincident_);
    if (!std::binary_search(coincident_.begin(), coincident_.end(), polygon_)) return std::nullopt;
    return seen_.distance;
  }

  const ray_scene& rays_;
  const float smallest_gap_;
  const glm::vec3 eye_;
  const std::uint32_t polygon_;
  const std::function<bool(std::uint32_t)>& contains_;
  std::priority_queue<part> parts_;
  std::uint64_t made_ = 0;
  sight seen_;
  std::vector<std::uint32_t> coincident_;
  polygon_sight result_;
};

}  // namespace

polygon_sight probe_polygon(const ray_scene& rays, float smallest_gap, const glm::vec3& eye, std::uint32_t polygon,
                            const std::function<bool(std::uint32_t)>& contains) {
  return looker(rays, smallest_gap, eye, polygon, contains).run();
}

}  // namespace sightcell::bake
