#pragma once
// What keeps the light of a far lamp, such as the sun, from a point (docs/shadows.md, "Which polygons are casters").
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "trace/ray_scene.h"

namespace sightcell::bake {

// A point of a surface, and the way from there to the light.
struct shadow_line {
  glm::vec3 point{0.0f};
  glm::vec3 to_light{0.0f};             // a unit vector
  float bias = 0.0f;                    // meters: what is nearer to the point casts no shadow on it
  std::uint32_t receiver = no_polygon;  // the polygon of the point: casts no shadow on it either
};

// What a set lacks to darken a point as the whole scene does.
struct lacking_casters {
  // The set needs one of these and has none: polygons by ascending distance from the point. All of them have a drawn
  // side toward the light, or none has.
  std::vector<std::uint32_t> one_of;
  // It needs each of these: non-occluders, which a host may move or hide. Ascending.
  std::vector<std::uint32_t> each;

  bool empty() const { return one_of.empty() && each.empty(); }
  void clear() { one_of.clear(), each.clear(); }
};

// Casts the ray of a line, and finds what the set lacks.
// Occluders block the light, MASK polygons where their alpha passes. A host draws a shadow map with the sides of the
// materials, or with both sides of everything, and the set must suffice for either one: where an occluder has a drawn
// side toward the light, the set needs one such occluder; where all of them turn their undrawn sides to the light, it
// needs one of them. Where no occluder has a drawn side toward the light, it also needs each non-occluder in between.
// BLEND polygons cast no shadow.
// contains: returns whether the host draws a polygon into its shadow map.
// out: overwritten; its storage is reused.
// Returns whether anything is lacking. Any thread.
bool find_lacking(const ray_scene& rays, const shadow_line& line, const std::function<bool(std::uint32_t)>& contains,
                  lacking_casters& out);

// Finds for which lines something may be lacking, in packets of eight rays. This is several times faster than
// find_lacking(), most of all if neighbors in the list begin near each other across the light.
// lines, suspect: of the same size. suspect[i] becomes 1 if lines[i] meets a blocker that the set lacks, and no
// occluder
//   of the set whose drawn side faces the light; else 0. Where it is 0, find_lacking() finds nothing, but for rounding
//   at edges.
// Any thread.
void find_suspects(const ray_scene& rays, std::span<const shadow_line> lines,
                   const std::function<bool(std::uint32_t)>& contains, std::span<std::uint8_t> suspect);

}  // namespace sightcell::bake
