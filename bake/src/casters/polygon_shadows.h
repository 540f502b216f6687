#pragma once
// Where the shadow of each polygon falls: what all cells of a scene ask of a sun, found once.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "trace/ray_scene.h"

namespace sightcell::bake {

// Points of a polygon whose shadows are looked at: its center, and one near each corner.
inline constexpr std::size_t shadow_points = 4;
// Meters from such a point along the light to where a ray begins: the polygon itself is no receiver.
inline constexpr float beside_polygon = 2e-3f;

struct polygon_shadows {
  glm::vec3 to_light{0.0f};
  // The occluder that the shadow of point i of polygon p falls on is receivers[p * shadow_points + i]; no_polygon: the
  // shadow leaves the scene.
  std::vector<std::uint32_t> receivers;
};

// Casts rays along the light from the points of the polygons that can cast a shadow. Takes 16 bytes per polygon.
// to_light: a unit vector.
// keep_going: asked a few times per second. When it returns false, the rest is left without receivers.
// Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
polygon_shadows shadows_of_polygons(const ray_scene& rays, const glm::vec3& to_light,
                                    const std::function<bool()>& keep_going);

// Returns point i of a polygon, 0 .. shadow_points - 1.
glm::vec3 shadow_point(const scene::world_geometry& geometry, std::uint32_t polygon, std::size_t i);

}  // namespace sightcell::bake
