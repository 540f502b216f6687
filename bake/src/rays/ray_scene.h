#pragma once
// The scene for rays: what a ray sees under the rules of seeing, and which places an eye can be at. Built from the
// flattened import alone; bake's finish and verify each build their own. Queries are const and may come from any
// thread.
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

inline constexpr std::uint32_t no_polygon = 0xFFFFFFFFu;

// What one ray sees.
struct sight {
  std::uint32_t front = no_polygon;   // the front occluding polygon; no_polygon: the ray leaves the scene
  float distance = 0.0f;              // to it, metres; infinity when there is none
  std::vector<std::uint32_t> before;  // BLEND polygons passed on the way, each once, ascending
};

class ray_scene {
 public:
  // geometry must outlive the ray scene. all_double_sided: sidedness of materials is ignored when seeing (never when
  // telling solids). Throws sightcell::error when Embree fails.
  ray_scene(const scene::world_geometry& geometry, bool all_double_sided);
  ~ray_scene();
  ray_scene(const ray_scene&) = delete;
  ray_scene& operator=(const ray_scene&) = delete;

  // direction is a unit vector. out is overwritten; its storage is reused.
  void look(const glm::vec3& eye, const glm::vec3& direction, sight& out) const;

  // Free points: they keep radius from every surface and are not inside a solid. A function of the place alone: of 64
  // fixed directions that ignore sidedness, at most a tenth of the hits may show the back of an opaque single-sided
  // polygon (design.md section 6). free[i] is set for points[i].
  void find_free(std::span<const glm::vec3> points, float radius, std::span<std::uint8_t> free) const;
  bool is_free(const glm::vec3& point, float radius) const;

  const scene::world_geometry& geometry() const { return geometry_; }
  bool sees_both_sides(std::uint32_t polygon) const {
    return all_double_sided_ || geometry_.kinds[polygon].double_sided;
  }

 private:
  struct embree;
  bool touches_surface(const glm::vec3& point, float radius) const;
  void find_solid(std::span<const glm::vec3> points, std::span<std::uint8_t> solid) const;

  const scene::world_geometry& geometry_;
  bool all_double_sided_;
  std::unique_ptr<embree> embree_;
};

}  // namespace sightcell::bake
