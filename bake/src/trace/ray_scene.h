#pragma once
// The scene for rays: what a ray sees under the rules of seeing, and which places an eye can be at. Built from the
// flattened import alone; bake's finish and verify each build their own. Queries are const and may come from any
// thread.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct embree_scene;
struct trace_context;

inline constexpr std::uint32_t no_polygon = 0xFFFFFFFFu;

// A polygon that a ray passes and that hides nothing: BLEND, or tagged so.
struct passed_polygon {
  std::uint32_t polygon = no_polygon;
  float distance = 0.0f;  // metres; the nearest, where the polygon is passed twice
};

// What one ray sees.
struct sight {
  std::uint32_t front = no_polygon;    // the front occluding polygon; no_polygon: the ray leaves the scene
  float distance = 0.0f;               // to it, metres; infinity when there is none
  std::vector<passed_polygon> before;  // passed on the way to it, each polygon once, ascending ids
};

// A ray: direction is a unit vector.
struct sight_line {
  glm::vec3 eye{0.0f}, direction{0.0f};
};

// Rule 2 of seeing: what lies within this of a surface is in the same place, metres.
inline float coincidence_reach(float distance) {
  return std::max(2e-4f, 2e-5f * distance);
}

class ray_scene {
 public:
  // geometry must outlive the ray scene. all_double_sided: sidedness of materials is ignored, and no place is taken for
  // a solid. Throws std::bad_alloc where Embree finds too little memory.
  ray_scene(const scene::world_geometry& geometry, bool all_double_sided);
  ~ray_scene();
  ray_scene(const ray_scene&) = delete;
  ray_scene& operator=(const ray_scene&) = delete;

  // direction is a unit vector. out is overwritten; its storage is reused.
  void trace(const glm::vec3& eye, const glm::vec3& direction, sight& out) const;

  // trace() of several rays, eight at a time: quicker, most where neighbors in the list go about the same way. What a
  // ray sees may differ from trace() by rounding at edges; it depends on the seven beside it and on nothing else. Both
  // spans have the same size; sights are overwritten, their storage is reused.
  void trace(std::span<const sight_line> lines, std::span<sight> out) const;

  // What a picture of a set alone shows there: the first polygon that hides along the ray among those of the set, under
  // rule 1; no_polygon: none.
  std::uint32_t front_of_set(const glm::vec3& eye, const glm::vec3& direction,
                             const std::function<bool(std::uint32_t)>& contains) const;

  // trace() where other polygons than those of the set are not there: what passes is told besides.
  void trace_against_set(const glm::vec3& eye, const glm::vec3& direction,
                         const std::function<bool(std::uint32_t)>& contains, sight& out) const;

  // trace() where no polygon is single-sided: all that keeps a line from going on in either direction.
  void trace_both_sides(const glm::vec3& eye, const glm::vec3& direction, sight& out) const;

  // Rule 2 of seeing: all polygons that are there from this side and lie within coincidence_reach of a place on the
  // ray, the one that was hit there included. out is overwritten: ascending, each once.
  void coincident(const glm::vec3& eye, const glm::vec3& direction, float distance,
                  std::vector<std::uint32_t>& out) const;

  // Rule 3 of seeing: does the sight line to a place at distance go through a crack narrower than smallest_gap? For one
  // of four directions across it both lines beside it, smallest_gap away, are blocked before the place by more than
  // 2 cm or 1 %. Up to that width nothing passes, from twice the width on everything. False where smallest_gap is 0.
  bool through_gap(const glm::vec3& eye, const glm::vec3& direction, float distance, float smallest_gap) const;

  // Polygons within reach of a point along a unit normal, front or back of it, whichever way they face; ascending.
  void stacked(const glm::vec3& point, const glm::vec3& normal, float reach, std::vector<std::uint32_t>& out) const;

  // Polygons that touch a box, ascending.
  std::vector<std::uint32_t> touching(const glm::vec3& min, const glm::vec3& max) const;

  // Free points: they keep radius from every surface and are not inside a solid. A function of the place alone: of 64
  // fixed directions that ignore sidedness, at most a tenth of the hits may show the back of an opaque single-sided
  // polygon with no front in the same place. free[i] is set for points[i].
  void find_free(std::span<const glm::vec3> points, float radius, std::span<std::uint8_t> free) const;
  bool is_free(const glm::vec3& point, float radius) const;
  // Is the point free, or a solid by a little: at most a quarter of the hits show backs? Of 64 other directions such a
  // place may well be free.
  bool is_nearly_free(const glm::vec3& point, float radius) const;

  const scene::world_geometry& geometry() const { return geometry_; }
  const embree_scene& embree() const { return *embree_; }  // for packets of rays
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
