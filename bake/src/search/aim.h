#pragma once
// Casts rays toward polygons that are probably visible, and collects every polygon along them that the set lacks.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "cell_set/cell_set.h"
#include "cell_set/point_order.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// A polygon that a ray found, and the viewpoint where the ray starts.
struct found_polygon {
  std::uint32_t polygon;
  glm::vec3 eye;
  bool operator<(const found_polygon& other) const {
    return polygon != other.polygon ? polygon < other.polygon : is_lower(eye, other.eye);
  }
};

// Returns a point that is uniform on the triangle.
glm::vec3 random_point(const triangle& t, random_stream& random);

// Returns a number that identifies a triangle by its position and not by its id. Random streams are keyed by it, so
// that a scene whose nodes are reordered, or whose instances are written another way, is sampled with the same rays.
std::uint64_t name_of(const triangle& t);

// Used by one thread. The set must not change while rays are cast.
class aimed_rays {
 public:
  aimed_rays(const ray_scene& rays, float smallest_gap, const cell_set& set)
      : rays_(rays), smallest_gap_(smallest_gap), set_(set) {}

  // Casts the ray from eye toward a point on the target. Appends to found each polygon along it that is visible and
  // not in the set. Returns whether the target is visible. Does nothing and returns false if eye and point coincide.
  bool aim(const glm::vec3& eye, const glm::vec3& point, std::uint32_t target, std::vector<found_polygon>& found);
  // Does the same for a ray that was cast before.
  // line, seen: the ray and its result.
  // length: distance from the eye to the point aimed at, meters.
  bool take(const sight_line& line, const sight& seen, float length, std::uint32_t target,
            std::vector<found_polygon>& found);

 private:
  // Appends the polygon to found unless the set contains it or it is visible only through a light leak.
  void add_new(std::uint32_t polygon, const glm::vec3& eye, const glm::vec3& direction, float distance,
               std::vector<found_polygon>& found) const;

  const ray_scene& rays_;
  float smallest_gap_;  // meters; polygons visible only through narrower gaps are not added (visibility rule 3)
  const cell_set& set_;
  std::vector<std::uint32_t> coincident_;
  sight seen_;
};

}  // namespace sightcell::bake
