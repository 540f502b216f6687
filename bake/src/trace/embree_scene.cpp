#include "trace/embree_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "trace/place_order.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

unsigned geometry_of(scene::polygon_kind kind) {
  if (kind.non_occluder) return kind.alpha_tested ? open_tested : open_untested;
  if (kind.alpha == scene::alpha_mode::blend) return blend_standing;
  return kind.alpha_tested ? tested_standing : opaque_standing;
}

// Builds the trees, unless a stop is asked.
void commit(RTCScene scene, const stop_request* stop) {
  if (stop)
    rtcSetSceneProgressMonitorFunction(
        scene, [](void* of, double) { return !static_cast<const stop_request*>(of)->asked(); },
        const_cast<stop_request*>(stop));
  rtcCommitScene(scene);
  if (stop) rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
}

// Returns whether the alpha of a MASK polygon reaches the cutoff at a hit with barycentric coordinates u, v.
bool passes(const scene::world_geometry& world, std::uint32_t test, float u, float v) {
  const scene::opacity known = world.opacity.at(test, u, v);
  if (known != scene::opacity::unknown) return known == scene::opacity::passes;
  const scene::masked_polygon& p = world.masked[test];
  const glm::vec2 uv = p.uvs[0] + (p.uvs[1] - p.uvs[0]) * u + (p.uvs[2] - p.uvs[0]) * v;
  const float alpha = p.alphas[0] + (p.alphas[1] - p.alphas[0]) * u + (p.alphas[2] - p.alphas[0]) * v;
  return world.masks[p.mask].passes(uv, alpha);
}

// Context filter for rule 1. It drops hits on the backs of single-sided polygons and on MASK polygons where their alpha
// is below the cutoff. Non-occluders are recorded, and the ray continues.
void keep_what_occludes(const RTCFilterFunctionNArguments* arguments) {
  const RTCFilterFunctionNArguments& a = *arguments;
  const auto* context = reinterpret_cast<const trace_context*>(a.context);
  for (unsigned i = 0; i < a.N; ++i) {
    if (a.valid[i] != -1) continue;
    const bool there = (!context->only || (*context->only)(context->scene->polygon_of(a, i))) &&
                       context->scene->is_there(a, i, context->all_double_sided);
    if (there && occludes(RTCHitN_geomID(a.hit, a.N, i)) && !context->pass_all) continue;
    if (there && context->passed)
      context->passed[RTCRayN_id(a.ray, a.N, i) - context->first_id].push_back(
          {context->scene->polygon_of(a, i), RTCRayN_tfar(a.ray, a.N, i)});
    a.valid[i] = 0;
  }
}

// Filter of the MASK geometry alone, so that rays that meet no MASK polygon do not pay for a filter.
void keep_where_masks_pass(const RTCFilterFunctionNArguments* arguments) {
  const RTCFilterFunctionNArguments& a = *arguments;
  const auto& scene = *static_cast<const embree_scene*>(a.geometryUserPtr);
  for (unsigned i = 0; i < a.N; ++i) {
    if (a.valid[i] != -1 || RTCRayN_id(a.ray, a.N, i) != ray_tests_masks) continue;
    if (!scene.is_there(a, i, scene.all_double_sided)) a.valid[i] = 0;
  }
}

// Arrays of a host may contain NaN, which Embree does not accept.
glm::vec3 finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? p : glm::vec3{0.0f};
}

bool has_avx512() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

}  // namespace

embree_scene::embree_scene(const scene::world_geometry& world, bool double_sided, embree_width width,
                           const stop_request* stop)
    : embree_scene(world, double_sided) {
  if (width == embree_width::widest && has_avx512()) device = rtcNewDevice("isa=avx512");
  if (!device) device = rtcNewDevice("isa=avx2");
  if (!device) device = rtcNewDevice(nullptr);
  if (!device) throw std::runtime_error("there is no Embree device");
  std::array<std::vector<std::uint32_t>, embree_geometry_count> polygons;
  for (std::uint32_t polygon = 0; polygon < world.kinds.size(); ++polygon)
    if (!world.kinds[polygon].absent) polygons[geometry_of(world.kinds[polygon])].push_back(polygon);
  for (std::vector<std::uint32_t>& of_geometry : polygons) sort_by_place(world, of_geometry);
  const masked_parts parts(world.opacity);
  solid = make_scene();
  RTCBuffer vertices = make_vertices();
  std::array<RTCGeometry, embree_geometry_count> geometries{};
  bool all_occlude = true;
  for (unsigned i = 0; i < embree_geometry_count; ++i) {
    if (polygons[i].empty() && i != opaque_standing) continue;
    if (is_tested(i)) {
      geometries[i] = make_tested(i, parts, polygons[i]);
    } else {
      ids[i] = std::move(polygons[i]);
      geometries[i] = make_geometry(ids[i], vertices);
    }
    if (occludes(i)) rtcAttachGeometryByID(solid, geometries[i], i);
    all_occlude = all_occlude && occludes(i);
  }
  commit(solid, stop);
  all = solid;
  if (!all_occlude) {
    all = make_scene();
    for (unsigned i = 0; i < embree_geometry_count; ++i)
      if (geometries[i]) rtcAttachGeometryByID(all, geometries[i], i);
    commit(all, stop);
  }
  for (const RTCGeometry geometry_of_scene : geometries)
    if (geometry_of_scene) rtcReleaseGeometry(geometry_of_scene);
  for (const unsigned i : {tested_standing, open_tested}) {
    if (polygons[i].empty()) continue;
    whole_ids[i] = std::move(polygons[i]);
    whole[i] = make_whole(i, vertices, stop);
  }
  rtcReleaseBuffer(vertices);
  if (stop) stop->check();  // before Embree's own error for it
  check("building the ray scene");
}

embree_scene::~embree_scene() {
  for (const RTCScene of_geometry : whole)
    if (of_geometry) rtcReleaseScene(of_geometry);
  if (all && all != solid) rtcReleaseScene(all);
  if (solid) rtcReleaseScene(solid);
  if (device) rtcReleaseDevice(device);
}

void embree_scene::check(const char* doing) const {
  const RTCError failure = rtcGetDeviceError(device);
  if (failure == RTC_ERROR_NONE) return;
  if (failure == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error(std::string(doing) + " failed with Embree error " +
                           std::to_string(static_cast<int>(failure)));
}

bool embree_scene::is_there(const RTCFilterFunctionNArguments& a, unsigned i, bool double_sided) const {
  const unsigned number = RTCHitN_geomID(a.hit, a.N, i), primitive = RTCHitN_primID(a.hit, a.N, i);
  if (!double_sided) {
    const float facing = RTCHitN_Ng_x(a.hit, a.N, i) * RTCRayN_dir_x(a.ray, a.N, i) +
                         RTCHitN_Ng_y(a.hit, a.N, i) * RTCRayN_dir_y(a.ray, a.N, i) +
                         RTCHitN_Ng_z(a.hit, a.N, i) * RTCRayN_dir_z(a.ray, a.N, i);
    // The table is read for backs alone, because it is seldom in the cache.
    if (facing > 0.0f && !geometry.kinds[ids[number][primitive]].double_sided) return false;
  }
  if (!is_tested(number)) return true;
  const tested_primitive& p = tests[number][primitive];
  return passes(geometry, p.masked, p.part.u + p.part.size * RTCHitN_u(a.hit, a.N, i),
                p.part.v + p.part.size * RTCHitN_v(a.hit, a.N, i));
}

// The memory is Embree's own, because Embree reads a few bytes past the last vertex.
RTCBuffer embree_scene::make_vertices(std::size_t count) const {
  RTCBuffer buffer = rtcNewBuffer(device, std::max<std::size_t>(count, 1) * sizeof(glm::vec3) + 16);
  check("allocating vertices");
  return buffer;
}

// All vertices, shared by the geometries without parts.
RTCBuffer embree_scene::make_vertices() const {
  RTCBuffer buffer = make_vertices(geometry.positions.size());
  auto* vertex = static_cast<glm::vec3*>(rtcGetBufferData(buffer));
  for (const glm::vec3& p : geometry.positions) *vertex++ = finite(p);
  return buffer;
}

RTCGeometry embree_scene::make_geometry(const std::vector<std::uint32_t>& polygons, RTCBuffer vertices) const {
  RTCGeometry made = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(made, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                    3 * sizeof(std::uint32_t), polygons.size()));
  rtcSetGeometryBuffer(made, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(glm::vec3),
                       geometry.positions.size());
  check("allocating geometry");
  for (const std::uint32_t polygon : polygons)
    for (std::size_t k = 0; k < 3; ++k) *index++ = geometry.indices[3 * std::size_t{polygon} + k];
  rtcCommitGeometry(made);
  return made;
}

// Makes the parts of polygons with an alpha test. Corners of parts on an edge that two polygons share are equal.
RTCGeometry embree_scene::make_tested(unsigned number, const masked_parts& parts,
                                      const std::vector<std::uint32_t>& polygons) {
  for (const std::uint32_t polygon : polygons) {
    const std::uint32_t masked = scene::masked_index(geometry, polygon);
    for (const masked_part& part : parts.of(masked)) {
      ids[number].push_back(polygon);
      tests[number].push_back({masked, part});
    }
  }
  const std::size_t count = tests[number].size();
  RTCBuffer vertices = make_vertices(3 * count);
  RTCGeometry made = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* index = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(made, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), count));
  rtcSetGeometryBuffer(made, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(glm::vec3), 3 * count);
  check("allocating geometry");
  std::iota(index, index + 3 * count, 0u);
  auto* vertex = static_cast<glm::vec3*>(rtcGetBufferData(vertices));
  for (std::size_t i = 0; i < count; ++i)
    for (const glm::vec3& corner : corners_of_part(bake::corners_of(geometry, ids[number][i]), tests[number][i].part))
      *vertex++ = finite(corner);
  rtcReleaseBuffer(vertices);
  rtcSetGeometryUserData(made, this);
  if (number == tested_standing) rtcSetGeometryIntersectFilterFunction(made, keep_where_masks_pass);
  rtcCommitGeometry(made);
  return made;
}

RTCScene embree_scene::make_whole(unsigned number, RTCBuffer vertices, const stop_request* stop) const {
  RTCScene made = make_scene();
  RTCGeometry polygons = make_geometry(whole_ids[number], vertices);
  rtcAttachGeometryByID(made, polygons, number);
  rtcReleaseGeometry(polygons);
  commit(made, stop);
  return made;
}

RTCScene embree_scene::make_scene() const {
  RTCScene made = rtcNewScene(device);
  // ROBUST keeps rays from passing between two triangles that share an edge. HIGH quality is not used: its spatial
  // splits depend on threads, and a bake must be repeatable.
  rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_MEDIUM);
  return made;
}

trace_context::trace_context(const embree_scene& where) : scene(&where), all_double_sided(where.all_double_sided) {
  rtcInitIntersectContext(&base);
  base.filter = keep_what_occludes;
}

}  // namespace sightcell::bake
