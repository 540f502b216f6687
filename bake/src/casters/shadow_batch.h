#pragma once
// Independent trials of the casters of a cell: rays from uniform valid viewpoints in uniform directions, as the
// certificate of camera sets draws them, and from what they show a ray toward the sun.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "bound/verification_rays.h"
#include "casters/sun_arc.h"
#include "trace/ray_scene.h"
#include "trace/shadow_ray.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// The two sets of a cell. Both are called from several threads.
struct caster_sets {
  std::function<bool(std::uint32_t)> camera;  // returns whether the camera set has a polygon: it is shown
  std::function<bool(std::uint32_t)> drawn;   // returns whether the host draws it into the shadow map
};

// A shadow that the casters lack.
struct missed_shadow {
  glm::vec3 eye{0.0f}, point{0.0f};
  glm::vec3 to_light{0.0f};
  std::uint32_t receiver = no_polygon;
  lacking_casters lacking;
};

// Tests the shadow on what a ray shows.
// Only polygons of the camera set count, because the host draws no others, and only their sides toward the sun, because
// a surface that is turned away from the sun is dark whatever the shadow map has.
// seen: of line.
// Appends to missed. Returns whether the ray is a miss: some point that it shows is lit by mistake.
bool lacks_shadow(const ray_scene& rays, const sight_line& line, const sight& seen, const glm::vec3& to_light,
                  const caster_sets& sets, std::vector<missed_shadow>& missed);

// The shadow ray of a point of a polygon. distance: of the point from the viewpoint, in meters.
shadow_line shadow_line_of(const glm::vec3& point, float distance, const glm::vec3& to_light, std::uint32_t receiver);

// Returns whether a polygon, seen along a direction, shows a side that faces the sun.
bool faces_light(const scene::world_geometry& geometry, std::uint32_t polygon, const glm::vec3& seen_along,
                 const glm::vec3& to_light);

// A batch of trials that is cast in parts. Viewpoints are tested late, as in bound_batch (bound_rays.h): those of the
// misses and some others, from which a lower limit for the number of trials follows.
class shadow_batch {
 public:
  // All references must outlive the batch. sets must return the same throughout.
  // valid_share: estimated share of the region that is valid viewpoints.
  shadow_batch(const ray_scene& rays, const viewpoint_region& where, float player_radius, double valid_share,
               const sun_arc& sun, const verification_stream& source, const caster_sets& sets)
      : rays_(rays),
        where_(where),
        player_radius_(player_radius),
        valid_share_(valid_share),
        sun_(sun),
        source_(source),
        sets_(sets) {}

  // Casts approximately this number of further trials. Runs in the TBB arena of the calling thread; the result does not
  // depend on the number of threads.
  void cast(std::uint64_t trials);
  // Casts this number of rays from given valid viewpoints. They find what is missing with fewer rays than cast(), but
  // they are not independent: a batch with such rays proves nothing.
  void cast_from(std::span<const glm::vec3> eyes, std::uint64_t count);
  // Returns a lower limit for the number of trials so far. It is wrong with a probability of at most `risk`.
  std::uint64_t trials(double risk) const;
  std::uint64_t misses() const { return misses_; }
  // Returns the cost so far: rays from viewpoints, and tested viewpoints.
  std::uint64_t spent() const { return cast_ + viewpoints_tested_; }
  // Returns all missed shadows, in a fixed order.
  const std::vector<missed_shadow>& missed() const { return missed_; }

 private:
  struct part;
  part cast_part(std::uint64_t count, std::uint64_t tests, random_stream random) const;
  part cast_part_from(std::span<const glm::vec3> eyes, std::uint64_t count, random_stream random) const;
  part cast_tested_part(std::uint64_t count, random_stream random) const;
  void cast_parts(std::uint64_t count, const std::function<part(std::uint64_t size, random_stream random)>& cast_one);

  const ray_scene& rays_;
  const viewpoint_region& where_;
  const float player_radius_;
  const double valid_share_;
  const sun_arc& sun_;
  const verification_stream source_;
  const caster_sets& sets_;
  std::uint64_t cast_ = 0, tested_ = 0, valid_ = 0;  // rays; viewpoints tested for their share; valid ones among those
  std::uint64_t misses_ = 0, viewpoints_tested_ = 0, parts_ = 0;
  std::vector<missed_shadow> missed_;
};

}  // namespace sightcell::bake
