#pragma once
// The flattened scene as Embree scenes, with filters that apply rule 1 of docs/method/visibility-rules.md (sides and
// alpha). ray_scene and the hemicube source of rays use it and may share one.
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sightcell/base/stop_request.h"
#include "sightcell/scene/scene.h"
#include "trace/masked_parts.h"

namespace sightcell::bake {

struct passed_polygon;

// Embree's geometries, by what their polygons do. The first two occlude, the first three are obstacles to viewpoints,
// and all are visible.
enum embree_geometry : unsigned {
  opaque_standing = 0,
  tested_standing,  // MASK
  blend_standing,
  open_untested,  // non-occluder by its marks. Not an obstacle, because a host may hide or move it
  open_tested,
  embree_geometry_count
};

// Returns whether polygons of a geometry occlude.
constexpr bool occludes(unsigned geometry) {
  return geometry <= tested_standing;
}
// Returns whether polygons of a geometry are obstacles: valid viewpoints keep the player radius from them.
constexpr bool keeps_eyes_off(unsigned geometry) {
  return geometry <= blend_standing;
}
// Returns whether polygons of a geometry have an alpha test (MASK).
constexpr bool is_tested(unsigned geometry) {
  return geometry == tested_standing || geometry == open_tested;
}

// The widest SIMD instructions that Embree may use.
enum class embree_width {
  avx2,    // packets of 8 rays: the same results on all machines
  widest,  // packets of 16 with AVX-512. Embree builds another tree then, so pixels at edges may differ
};

// A primitive of a geometry with an alpha test: a part of a masked polygon.
struct tested_primitive {
  std::uint32_t masked = 0;  // index in world_geometry::masked
  masked_part part;
};

struct embree_scene {
  // Builds the trees of a scene.
  // world: must outlive this object.
  // all_double_sided: the sidedness of materials is ignored.
  // stop: looked at by the constructor only; null for none.
  // Throws std::bad_alloc if Embree runs out of memory, std::runtime_error on any other error of Embree, and
  // step_stopped if stop was asked.
  embree_scene(const scene::world_geometry& world, bool all_double_sided, embree_width width,
               const stop_request* stop = nullptr);
  ~embree_scene();
  embree_scene(const embree_scene&) = delete;
  embree_scene& operator=(const embree_scene&) = delete;

  // Throws if Embree recorded an error: std::bad_alloc if it ran out of memory, else std::runtime_error.
  // doing: subject of the message, such as "building the ray scene".
  void check(const char* doing) const;
  // Returns a new empty Embree scene with the flags and build quality that all scenes here share.
  RTCScene make_scene() const;
  // For Embree's filters: returns the source id of the polygon that ray i hits.
  std::uint32_t polygon_of(const RTCFilterFunctionNArguments& a, unsigned i) const {
    return ids[RTCHitN_geomID(a.hit, a.N, i)][RTCHitN_primID(a.hit, a.N, i)];
  }
  // For Embree's filters: returns whether the hit of ray i counts under rule 1. It does not on the back of a
  // single-sided polygon, or where the alpha of a MASK polygon is below the cutoff.
  bool is_there(const RTCFilterFunctionNArguments& a, unsigned i, bool double_sided) const;

  const scene::world_geometry& geometry;
  const bool all_double_sided;
  RTCDevice device = nullptr;
  RTCScene solid = nullptr;  // occluders only: for tests for solids and for blocked sight lines
  RTCScene all = nullptr;    // occluders and non-occluders; equal to solid if there are no non-occluders
  // For each geometry with an alpha test: a scene of whole polygons in this geometry, for tests of viewpoints and
  // queries of distances, and the source ids of its primitives. Null and empty where there are none.
  std::array<RTCScene, embree_geometry_count> whole{};
  std::array<std::vector<std::uint32_t>, embree_geometry_count> whole_ids;
  // For each geometry: ids has the source id of each primitive. For geometries with an alpha test, a primitive is a
  // part of a polygon, see tests.
  std::array<std::vector<std::uint32_t>, embree_geometry_count> ids;
  std::array<std::vector<tested_primitive>, embree_geometry_count> tests;

 private:
  // The public constructor delegates to this one, so that the destructor runs if its body throws.
  embree_scene(const scene::world_geometry& world, bool double_sided)
      : geometry(world), all_double_sided(double_sided) {}
  RTCBuffer make_vertices(std::size_t count) const;
  RTCBuffer make_vertices() const;
  RTCGeometry make_geometry(const std::vector<std::uint32_t>& polygons, RTCBuffer vertices) const;
  RTCGeometry make_tested(unsigned number, const masked_parts& parts, const std::vector<std::uint32_t>& polygons);
  RTCScene make_whole(unsigned number, RTCBuffer vertices, const stop_request* stop) const;
};

// Id of rays that have no filter in their context. For them the filter of the occluding MASK geometry tests alpha and
// side. For rays with other ids the filter in their context does that.
inline constexpr unsigned ray_tests_masks = 1;

// The context of a ray query: Embree's context, and the data of the filter. base is the first member, because the
// filter casts Embree's pointer to this type.
struct trace_context {
  explicit trace_context(const embree_scene& where);  // installs the filter

  RTCIntersectContext base{};
  const embree_scene* scene;
  bool all_double_sided;
  std::vector<passed_polygon>* passed = nullptr;  // non-occluders that the ray passes; null: not recorded
  unsigned first_id = 0;                          // ray with id i appends to passed[i - first_id]
  bool pass_all = false;                          // occluders are recorded in passed too, and do not end the ray
  // The ray ignores polygons for which this is false; null: it ignores none.
  const std::function<bool(std::uint32_t)>* only = nullptr;
};

}  // namespace sightcell::bake
