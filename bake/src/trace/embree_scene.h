#pragma once
// The flattened scene in Embree, and what a ray meets there under rule 1 of seeing. For ray_scene and the hemicube
// source of rays, which may share one.
#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct passed_polygon;

// Embree's geometries, in order of what they do: the first two hide, the first three keep eyes off, all are seen.
enum embree_geometry : unsigned {
  opaque_standing = 0,
  tested_standing,  // MASK
  blend_standing,
  open_untested,  // never hides by its tags, because it may move: where it stands today says little
  open_tested,
  embree_geometry_count
};

constexpr bool occludes(unsigned geometry) {
  return geometry <= tested_standing;
}
constexpr bool keeps_eyes_off(unsigned geometry) {
  return geometry <= blend_standing;
}
constexpr bool is_tested(unsigned geometry) {
  return geometry == tested_standing || geometry == open_tested;
}

enum class embree_width {
  avx2,    // rays in packets of 8: the same on all machines
  widest,  // in packets of 16 where there is AVX-512. Its tree is another one: pixels at edges may differ
};

struct embree_scene {
  // geometry must outlive the scene. all_double_sided: sidedness of materials is ignored. Throws std::bad_alloc where
  // Embree finds too little memory.
  embree_scene(const scene::world_geometry& world, bool all_double_sided, embree_width width);
  ~embree_scene();
  embree_scene(const embree_scene&) = delete;
  embree_scene& operator=(const embree_scene&) = delete;

  void check(const char* doing) const;
  RTCScene make_scene() const;
  // For Embree's filters: the polygon that ray i meets, and whether it is there, from that side and by its alpha.
  std::uint32_t polygon_of(const RTCFilterFunctionNArguments& a, unsigned i) const {
    return ids[RTCHitN_geomID(a.hit, a.N, i)][RTCHitN_primID(a.hit, a.N, i)];
  }
  bool is_there(const RTCFilterFunctionNArguments& a, unsigned i, bool double_sided) const;

  const scene::world_geometry& geometry;
  const bool all_double_sided;
  RTCDevice device = nullptr;
  RTCScene solid = nullptr;  // what hides: solids are told by it, and sight lines blocked
  RTCScene all = nullptr;    // with what is seen and does not hide; the same scene where there is nothing of it
  // Per geometry, primitive number to source id; of tested ones to the number in world_geometry::masked.
  std::array<std::vector<std::uint32_t>, embree_geometry_count> ids, tests;

 private:
  // So that the destructor runs when the rest of the constructor throws.
  embree_scene(const scene::world_geometry& world, bool double_sided)
      : geometry(world), all_double_sided(double_sided) {}
  RTCBuffer make_vertices() const;
  RTCGeometry make_geometry(unsigned number, RTCBuffer vertices);
};

// A ray with this id tests the alpha and the side of what is masked by itself: no filter needs to be in its context.
// Others leave that to the filter in theirs.
inline constexpr unsigned ray_tests_masks = 1;

// Embree's context, first, so that the filter can be given the rest.
struct trace_context {
  explicit trace_context(const embree_scene& where);  // with the filter below

  RTCIntersectContext base{};
  const embree_scene* scene;
  bool all_double_sided;
  std::vector<passed_polygon>* passed = nullptr;             // what was met and does not hide; null: nobody asks
  unsigned first_id = 0;                                     // ray id i notes into passed[i - first_id]
  bool pass_all = false;                                     // what hides is noted there too, and the ray goes on
  const std::function<bool(std::uint32_t)>* only = nullptr;  // other polygons are not there; null: all are
};

}  // namespace sightcell::bake
