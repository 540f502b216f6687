#pragma once
// The scene for rays: what a ray hits under the visibility rules (docs/method/visibility-rules.md), and which
// viewpoints are valid. It is built from the flattened import alone. A bake and `sightcell verify` each build their
// own. All queries are const and may be called from any thread.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "sightcell/base/stop_request.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct embree_scene;
struct trace_context;

inline constexpr std::uint32_t no_polygon = 0xFFFFFFFFu;

// A non-occluder that a ray passes: a BLEND polygon, or one whose marks make it a non-occluder.
struct passed_polygon {
  std::uint32_t polygon = no_polygon;
  float distance = 0.0f;  // meters; to the nearest hit, if the ray hits the polygon twice
};

// The polygons that are visible along one ray.
struct sight {
  std::uint32_t front = no_polygon;    // the first occluder; no_polygon: the ray leaves the scene
  float distance = 0.0f;               // meters to the first occluder; infinity if there is none
  std::vector<passed_polygon> before;  // non-occluders in front of it, each polygon once, by ascending id
};

// A ray. direction is a unit vector.
struct sight_line {
  glm::vec3 eye{0.0f}, direction{0.0f};
};

// Returns the reach e of rule 2 in meters: surfaces within e of each other count as being in the same place.
// distance: from the viewpoint, in meters.
inline float coincidence_reach(float distance) {
  return std::max(2e-4f, 2e-5f * distance);
}

// Returns how far from a ray its result is decided, in meters: through_gap() looks along lines beside it (rule 3).
inline float reach_beside(float smallest_gap) {
  return smallest_gap + 1e-4f;
}

class ray_scene {
 public:
  // Builds the scene for rays.
  // geometry: must outlive this object.
  // all_double_sided: the sidedness of materials is ignored, and no viewpoint counts as inside a solid.
  // stop: looked at by the constructor only; null for none.
  // Throws std::bad_alloc if Embree runs out of memory, and step_stopped if stop was asked.
  ray_scene(const scene::world_geometry& geometry, bool all_double_sided, const stop_request* stop = nullptr);
  ~ray_scene();
  ray_scene(const ray_scene&) = delete;
  ray_scene& operator=(const ray_scene&) = delete;

  // Casts a ray and finds the polygons that are visible along it.
  // direction: a unit vector.
  // out: overwritten; its storage is reused.
  void trace(const glm::vec3& eye, const glm::vec3& direction, sight& out) const;

  // Casts several rays, in packets of eight. This is faster than one at a time, most of all if neighbors in the list
  // have similar origins and directions. At edges, results may differ by rounding from those of a single ray. They
  // depend on the other rays of the packet and on nothing else.
  // lines, out: of the same size. out is overwritten; its storage is reused.
  void trace(std::span<const sight_line> lines, std::span<sight> out) const;

  // Casts a ray into a scene that has only the polygons of a set, as a picture of that set would show it.
  // Returns the first occluder among them under rule 1, or no_polygon.
  std::uint32_t front_of_set(const glm::vec3& eye, const glm::vec3& direction,
                             const std::function<bool(std::uint32_t)>& contains) const;

  // As above, and also finds the non-occluders of the set in front of that occluder.
  void trace_against_set(const glm::vec3& eye, const glm::vec3& direction,
                         const std::function<bool(std::uint32_t)>& contains, sight& out) const;

  // Casts a ray as if all polygons were double-sided. The result is what blocks the line in either direction.
  void trace_both_sides(const glm::vec3& eye, const glm::vec3& direction, sight& out) const;

  // Finds all polygons at one point of a ray: those that are present from this side (rule 1) and within
  // coincidence_reach(distance) of the point, along the ray (rule 2). They include the polygon that the ray hit there.
  // distance: of the point from eye, in meters.
  // out: overwritten; ascending, each polygon once.
  void coincident(const glm::vec3& eye, const glm::vec3& direction, float distance,
                  std::vector<std::uint32_t>& out) const;

  // Returns whether a sight line passes through a gap that is too narrow to count (light-leak tolerance, rule 3).
  // Four directions across the line are tried: 0, 45, 90 and 135 degrees. The gap is too narrow if, for one of them,
  // both parallel lines at the distance smallest_gap are blocked before the visible point by more than max(2 cm, 1 % of
  // the distance). Gaps up to that width transmit nothing, gaps of twice the width transmit everything.
  // distance: of the visible point from eye, in meters.
  // smallest_gap: in meters; 0 returns false.
  bool through_gap(const glm::vec3& eye, const glm::vec3& direction, float distance, float smallest_gap) const;

  // Finds the polygons within reach of a point along a normal, on both sides of it, whichever way they face.
  // normal: a unit vector.
  // reach: in meters.
  // out: overwritten; ascending, each polygon once.
  void stacked(const glm::vec3& point, const glm::vec3& normal, float reach, std::vector<std::uint32_t>& out) const;

  // Returns the polygons that touch a box, ascending.
  std::vector<std::uint32_t> touching(const glm::vec3& min, const glm::vec3& max) const;

  // Finds which points are valid viewpoints. A valid viewpoint keeps `radius` from every obstacle and is not inside a
  // solid: of 64 fixed directions that ignore sidedness, at most a tenth of the hits show the back of an opaque
  // single-sided polygon with no front in the same place. The result for a point depends on that point alone.
  // radius: in meters.
  // free: free[i] becomes 1 if points[i] is valid, else 0.
  void find_valid(std::span<const glm::vec3> points, float radius, std::span<std::uint8_t> free) const;
  // Returns whether one point is a valid viewpoint.
  bool is_valid(const glm::vec3& point, float radius) const;
  // Returns whether a point is a valid viewpoint or nearly one: at most a quarter of the hits show backs. With 64 other
  // directions such a point might be valid.
  bool is_nearly_valid(const glm::vec3& point, float radius) const;

  const scene::world_geometry& geometry() const { return geometry_; }
  const embree_scene& embree() const { return *embree_; }  // for callers that trace their own packets
  // Returns whether a polygon is visible from both sides.
  bool sees_both_sides(std::uint32_t polygon) const {
    return all_double_sided_ || geometry_.kinds[polygon].double_sided;
  }

 private:
  void trace(trace_context& context, const glm::vec3& eye, const glm::vec3& direction, sight& out) const;
  bool touches_surface(const glm::vec3& point, float radius) const;
  void find_solid(std::span<const glm::vec3> points, int one_in, std::span<std::uint8_t> solid) const;
  void find_clear(std::span<const glm::vec3> points, float radius, int one_in, std::span<std::uint8_t> clear) const;

  const scene::world_geometry& geometry_;
  bool all_double_sided_;
  std::unique_ptr<embree_scene> embree_;
};

}  // namespace sightcell::bake
