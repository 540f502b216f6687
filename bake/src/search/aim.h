#pragma once
// A ray aimed at a polygon that is likely seen, and all that it sees on its way.
#include <cstdint>
#include <glm/vec3.hpp>
#include <tuple>
#include <vector>

#include "cell_set/cell_set.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// An order of places that does not depend on ids.
inline bool is_lower(const glm::vec3& a, const glm::vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

struct found_polygon {
  std::uint32_t polygon;
  glm::vec3 eye;
  bool operator<(const found_polygon& other) const {
    return polygon != other.polygon ? polygon < other.polygon : is_lower(eye, other.eye);
  }
};

// Uniform on the triangle.
glm::vec3 random_point(const triangle& t, random_stream& random);

// Random numbers are named by where polygons are and never by their ids: the same scene in another order of nodes, or
// with its instances written another way, is cast the same rays.
std::uint64_t name_of(const triangle& t);

// One thread's. The set must not change while rays are aimed.
class aimed_rays {
 public:
  aimed_rays(const ray_scene& rays, float smallest_gap, const cell_set& set)
      : rays_(rays), smallest_gap_(smallest_gap), set_(set) {}

  // Casts the ray from eye toward a point on the target and adds to found all that it sees and the set does not have;
  // true when the target is among what it sees. Nothing where eye and point coincide.
  bool aim(const glm::vec3& eye, const glm::vec3& point, std::uint32_t target, std::vector<found_polygon>& found);
  // The same of a ray that was cast already: what it saw, and how far away along it the point is.
  bool take(const sight_line& line, const sight& seen, float length, std::uint32_t target,
            std::vector<found_polygon>& found);

 private:
  void note(std::uint32_t polygon, const glm::vec3& eye, const glm::vec3& direction, float distance,
            std::vector<found_polygon>& found) const;

  const ray_scene& rays_;
  float smallest_gap_;  // what is seen only through narrower cracks is not noted (rule 3)
  const cell_set& set_;
  std::vector<std::uint32_t> coincident_;
  sight seen_;
};

}  // namespace sightcell::bake
