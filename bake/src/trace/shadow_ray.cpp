#include "trace/shadow_ray.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "trace/embree_scene.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t shadow_packet = 8;  // rays per Embree packet, the width of AVX2

// Returns whether a drawn side of the polygon that ray i hits faces the light.
bool turns_drawn_side(const embree_scene& scene, scene::polygon_kind kind, const RTCFilterFunctionNArguments& a,
                      unsigned i) {
  const float along = RTCHitN_Ng_x(a.hit, a.N, i) * RTCRayN_dir_x(a.ray, a.N, i) +
                      RTCHitN_Ng_y(a.hit, a.N, i) * RTCRayN_dir_y(a.ray, a.N, i) +
                      RTCHitN_Ng_z(a.hit, a.N, i) * RTCRayN_dir_z(a.ray, a.N, i);
  return kind.double_sided || scene.all_double_sided || along > 0.0f;
}

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
    const bool is_drawn = turns_drawn_side(*context->scene, kind, a, i);
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

// What the rays of a packet passed so far. Embree's context is the first member, because the filter casts its pointer.
struct shadow_packet_context {
  RTCIntersectContext base{};
  const embree_scene* scene = nullptr;
  const std::function<bool(std::uint32_t)>* contains = nullptr;
  std::array<std::uint32_t, shadow_packet> receivers{};  // by the id of the ray, less first_shadow_id
  std::array<bool, shadow_packet> meets_lacking{};
};

// Ids that the filter of the MASK geometry ignores.
constexpr unsigned first_shadow_id = ray_tests_masks + 1;

// Ends a ray where note_blockers() ends it, and notes whether it met a blocker that the set lacks. Alpha is tested last
// and only where it decides.
void note_lacking(const RTCFilterFunctionNArguments* arguments) {
  const RTCFilterFunctionNArguments& a = *arguments;
  auto* context = reinterpret_cast<shadow_packet_context*>(a.context);
  for (unsigned i = 0; i < a.N; ++i) {
    if (a.valid[i] != -1) continue;
    a.valid[i] = 0;
    const unsigned ray = RTCRayN_id(a.ray, a.N, i) - first_shadow_id;
    const std::uint32_t polygon = context->scene->polygon_of(a, i);
    const scene::polygon_kind kind = context->scene->geometry.kinds[polygon];
    if (polygon == context->receivers[ray] || kind.alpha == scene::alpha_mode::blend) continue;
    const bool in_set = (*context->contains)(polygon);
    const bool ends = in_set && !kind.non_occluder && turns_drawn_side(*context->scene, kind, a, i);
    if (!ends && (in_set || context->meets_lacking[ray])) continue;
    if (!context->scene->is_there(a, i, true)) continue;
    if (ends)
      a.valid[i] = -1;
    else
      context->meets_lacking[ray] = true;
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

void find_suspects(const ray_scene& rays, std::span<const shadow_line> lines,
                   const std::function<bool(std::uint32_t)>& contains, std::span<std::uint8_t> suspect) {
  shadow_packet_context context;
  rtcInitIntersectContext(&context.base);
  context.base.filter = note_lacking;
  context.scene = &rays.embree();
  context.contains = &contains;
  for (std::size_t first = 0; first < lines.size(); first += shadow_packet) {
    const std::size_t count = std::min(shadow_packet, lines.size() - first);
    alignas(32) int valid[shadow_packet];
    RTCRay8 r{};
    for (std::size_t i = 0; i < shadow_packet; ++i) {
      const shadow_line& line = lines[first + std::min(i, count - 1)];
      valid[i] = i < count ? -1 : 0;
      r.org_x[i] = line.point.x, r.org_y[i] = line.point.y, r.org_z[i] = line.point.z;
      r.dir_x[i] = line.to_light.x, r.dir_y[i] = line.to_light.y, r.dir_z[i] = line.to_light.z;
      r.tnear[i] = line.bias, r.tfar[i] = std::numeric_limits<float>::infinity();
      r.mask[i] = ~0u;
      r.id[i] = first_shadow_id + static_cast<unsigned>(i);
      context.receivers[i] = line.receiver;
      context.meets_lacking[i] = false;
    }
    rtcOccluded8(valid, rays.embree().all, &context.base, &r);
    // Embree sets tfar to -infinity on a hit.
    for (std::size_t i = 0; i < count; ++i) suspect[first + i] = context.meets_lacking[i] && r.tfar[i] >= 0.0f ? 1 : 0;
  }
}

}  // namespace sightcell::bake
