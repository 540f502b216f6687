#include "trace/shadow_ray.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "trace/embree_scene.h"

namespace sightcell::bake {
namespace {

// What a shadow ray passed so far. Embree's context is the first member, because the filter casts its pointer.
struct shadow_context {
  RTCIntersectContext base{};
  const embree_scene* scene = nullptr;
  const std::function<bool(std::uint32_t)>* contains = nullptr;
  std::uint32_t receiver = no_polygon;
  bool undrawn_in_set = false;  // an occluder of the set turns its undrawn side to the light
  // Occluders that the set lacks, by distance: with a drawn side toward the light, and without.
  std::vector<std::pair<float, std::uint32_t>>*drawn = nullptr, *undrawn = nullptr;
  std::vector<std::uint32_t>* movable = nullptr;  // non-occluders that the set lacks
};

// Ends the ray at an occluder of the set that turns a drawn side to the light, and notes everything else.
void note_blockers(const RTCFilterFunctionNArguments* arguments) {
  const RTCFilterFunctionNArguments& a = *arguments;
  auto* context = reinterpret_cast<shadow_context*>(a.context);
  for (unsigned i = 0; i < a.N; ++i) {
    if (a.valid[i] != -1) continue;
    a.valid[i] = 0;
    const std::uint32_t polygon = context->scene->polygon_of(a, i);
    const scene::polygon_kind kind = context->scene->geometry.kinds[polygon];
    if (polygon == context->receiver || kind.alpha == scene::alpha_mode::blend) continue;
    if (!context->scene->is_there(a, i, true)) continue;
    const float along = RTCHitN_Ng_x(a.hit, a.N, i) * RTCRayN_dir_x(a.ray, a.N, i) +
                        RTCHitN_Ng_y(a.hit, a.N, i) * RTCRayN_dir_y(a.ray, a.N, i) +
                        RTCHitN_Ng_z(a.hit, a.N, i) * RTCRayN_dir_z(a.ray, a.N, i);
    const bool is_drawn = kind.double_sided || context->scene->all_double_sided || along > 0.0f;
    const bool in_set = (*context->contains)(polygon);
    if (kind.non_occluder) {
      if (!in_set) context->movable->push_back(polygon);
    } else if (!in_set) {
      (is_drawn ? context->drawn : context->undrawn)->emplace_back(RTCRayN_tfar(a.ray, a.N, i), polygon);
    } else if (is_drawn) {
      a.valid[i] = -1;
    } else {
      context->undrawn_in_set = true;
    }
  }
}

void put_sorted(std::vector<std::pair<float, std::uint32_t>>& by_distance, std::vector<std::uint32_t>& out) {
  std::sort(by_distance.begin(), by_distance.end());
  for (const auto& [distance, polygon] : by_distance)
    if (std::find(out.begin(), out.end(), polygon) == out.end()) out.push_back(polygon);
}

}  // namespace

bool find_lacking(const ray_scene& rays, const shadow_line& line, const std::function<bool(std::uint32_t)>& contains,
                  lacking_casters& out) {
  thread_local std::vector<std::pair<float, std::uint32_t>> drawn, undrawn;
  drawn.clear(), undrawn.clear(), out.clear();
  shadow_context context;
  rtcInitIntersectContext(&context.base);
  context.base.filter = note_blockers;
  context.scene = &rays.embree();
  context.contains = &contains;
  context.receiver = line.receiver;
  context.drawn = &drawn, context.undrawn = &undrawn, context.movable = &out.each;
  RTCRay r{};
  r.org_x = line.point.x, r.org_y = line.point.y, r.org_z = line.point.z;
  r.dir_x = line.to_light.x, r.dir_y = line.to_light.y, r.dir_z = line.to_light.z;
  r.tnear = line.bias, r.tfar = std::numeric_limits<float>::infinity();
  r.mask = ~0u;
  rtcOccluded1(rays.embree().all, &context.base, &r);
  if (r.tfar < 0.0f || !drawn.empty()) out.each.clear();  // Embree sets tfar to -infinity on a hit
  if (r.tfar < 0.0f) return false;
  if (!drawn.empty()) {
    put_sorted(drawn, out.one_of);
  } else if (!context.undrawn_in_set) {
    put_sorted(undrawn, out.one_of);
  }
  std::sort(out.each.begin(), out.each.end());
  out.each.erase(std::unique(out.each.begin(), out.each.end()), out.each.end());
  return !out.empty();
}

}  // namespace sightcell::bake
