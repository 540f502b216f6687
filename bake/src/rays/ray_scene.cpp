#include "rays/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>
#include <stdexcept>
#include <string>

#include "rays/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t solid_directions = 64;
constexpr std::size_t packet = 8;  // rays per Embree packet: the width of AVX2

// Evenly spread over the sphere (Fibonacci lattice), turned so that no direction lies in an axis plane.
std::array<glm::vec3, solid_directions> make_solid_directions() {
  std::array<glm::vec3, solid_directions> directions{};
  for (std::size_t i = 0; i < solid_directions; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(solid_directions);
    const double angle = 0.37 + static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    directions[i] = glm::vec3(glm::dvec3(r * std::cos(angle), z, r * std::sin(angle)));
  }
  return directions;
}

const std::array<glm::vec3, solid_directions>& fixed_directions() {
  static const auto directions = make_solid_directions();
  return directions;
}

// Embree's geometries, in order of what they do: the first two hide, the first three keep eyes off, all are seen.
enum : unsigned {
  opaque_standing = 0,
  tested_standing,  // MASK
  blend_standing,
  open_untested,  // never hides by its tags, because it may move: where it stands today says little
  open_tested,
  geometry_count
};

constexpr bool hides(unsigned geometry) {
  return geometry <= tested_standing;
}
constexpr bool keeps_eyes_off(unsigned geometry) {
  return geometry <= blend_standing;
}
constexpr bool is_tested(unsigned geometry) {
  return geometry == tested_standing || geometry == open_tested;
}

unsigned geometry_of(scene::polygon_kind kind) {
  if (kind.never_hides) return kind.alpha_tested ? open_tested : open_untested;
  if (kind.alpha == scene::alpha_mode::blend) return blend_standing;
  return kind.alpha_tested ? tested_standing : opaque_standing;
}

// Embree's context, first, so that the filter can be given the rest.
struct look_context {
  RTCIntersectContext base{};
  const std::vector<std::uint32_t>* ids = nullptr;    // per geometry: primitive number to source id
  const std::vector<std::uint32_t>* tests = nullptr;  // of tested ones: to the number in world_geometry::masked
  const scene::world_geometry* geometry = nullptr;
  bool all_double_sided = false;
  std::vector<passed_polygon>* passed = nullptr;  // what was met and does not hide; null: nobody asks
  bool pass_all = false;                          // what hides is noted there too, and the ray goes on
};

// Whether a masked polygon is there at a hit.
bool passes(const scene::world_geometry& world, const scene::masked_polygon& p, float u, float v) {
  const glm::vec2 uv = p.uvs[0] + (p.uvs[1] - p.uvs[0]) * u + (p.uvs[2] - p.uvs[0]) * v;
  const float alpha = p.alphas[0] + (p.alphas[1] - p.alphas[0]) * u + (p.alphas[2] - p.alphas[0]) * v;
  return world.masks[p.mask].passes(uv, alpha);
}

// Rule 1: backs of single-sided polygons are not there, nor is a MASK where its alpha is below the cutoff; what never
// hides is noted and lets the ray on.
void keep_what_occludes(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const look_context*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != -1) continue;
    const unsigned geometry = RTCHitN_geomID(arguments->hit, arguments->N, i);
    const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
    const std::uint32_t polygon = context->ids[geometry][primitive];
    const scene::polygon_kind kind = context->geometry->kinds[polygon];
    const float facing =
        RTCHitN_Ng_x(arguments->hit, arguments->N, i) * RTCRayN_dir_x(arguments->ray, arguments->N, i) +
        RTCHitN_Ng_y(arguments->hit, arguments->N, i) * RTCRayN_dir_y(arguments->ray, arguments->N, i) +
        RTCHitN_Ng_z(arguments->hit, arguments->N, i) * RTCRayN_dir_z(arguments->ray, arguments->N, i);
    const bool shows_back = facing > 0.0f && !kind.double_sided && !context->all_double_sided;
    const bool there =
        !shows_back && (!is_tested(geometry) ||
                        passes(*context->geometry, context->geometry->masked[context->tests[geometry][primitive]],
                               RTCHitN_u(arguments->hit, arguments->N, i), RTCHitN_v(arguments->hit, arguments->N, i)));
    if (there && hides(geometry) && !context->pass_all) continue;
    if (there && context->passed) context->passed->push_back({polygon, RTCRayN_tfar(arguments->ray, arguments->N, i)});
    arguments->valid[i] = 0;
  }
}

struct nearness {
  const scene::world_geometry* geometry;
  const std::vector<std::uint32_t>* ids;
  bool touched = false;
};

// One ray per point, all along direction; lanes beyond the points repeat the last one.
RTCRayHit8 parallel_rays(std::span<const glm::vec3> points, const glm::vec3& direction) {
  RTCRayHit8 r{};
  for (std::size_t i = 0; i < packet; ++i) {
    const glm::vec3& p = points[std::min(i, points.size() - 1)];
    r.ray.org_x[i] = p.x, r.ray.org_y[i] = p.y, r.ray.org_z[i] = p.z;
    r.ray.dir_x[i] = direction.x, r.ray.dir_y[i] = direction.y, r.ray.dir_z[i] = direction.z;
    r.ray.tfar[i] = std::numeric_limits<float>::infinity();
    r.ray.mask[i] = ~0u;
    r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  return r;
}

RTCRay one_ray(const glm::vec3& eye, const glm::vec3& direction, float from, float to) {
  RTCRay r{};
  r.org_x = eye.x, r.org_y = eye.y, r.org_z = eye.z;
  r.dir_x = direction.x, r.dir_y = direction.y, r.dir_z = direction.z;
  r.tnear = from, r.tfar = to;
  r.mask = ~0u;
  return r;
}

bool note_touch(RTCPointQueryFunctionArguments* arguments) {
  auto* near = static_cast<nearness*>(arguments->userPtr);
  if (!keeps_eyes_off(arguments->geomID)) return false;
  const std::uint32_t polygon = near->ids[arguments->geomID][arguments->primID];
  const glm::vec3 point{arguments->query->x, arguments->query->y, arguments->query->z};
  const float distance = distance_to_triangle(point, corners_of(*near->geometry, polygon));
  if (distance >= arguments->query->radius) return false;
  near->touched = true;
  arguments->query->radius = 0.0f;  // one is enough: ends the query
  return true;
}

}  // namespace

struct ray_scene::embree {
  RTCDevice device = nullptr;
  RTCScene solid = nullptr;  // what hides: solids are told by it, and sight lines blocked
  RTCScene all = nullptr;    // with what is seen and does not hide; the same scene where there is nothing of it
  std::array<std::vector<std::uint32_t>, geometry_count> ids, tests;

  look_context context(const ray_scene& rays) const;
  // All that a ray meets and that is there, whether it hides or not.
  void collect(look_context& context, const RTCRay& along, std::vector<std::uint32_t>& out) const;

  ~embree() {
    if (all && all != solid) rtcReleaseScene(all);
    if (solid) rtcReleaseScene(solid);
    if (device) rtcReleaseDevice(device);
  }

  void check(const char* doing) const {
    const RTCError failure = rtcGetDeviceError(device);
    if (failure == RTC_ERROR_NONE) return;
    if (failure == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::runtime_error(std::string(doing) + " failed with Embree error " +
                             std::to_string(static_cast<int>(failure)));
  }

  // All vertices, once for all geometries; Embree's own memory, because it reads a few bytes past the last one.
  RTCBuffer make_vertices(const scene::world_geometry& world) const {
    RTCBuffer buffer = rtcNewBuffer(device, std::max<std::size_t>(world.positions.size(), 1) * sizeof(glm::vec3) + 16);
    check("allocating vertices");
    auto* vertex = static_cast<glm::vec3*>(rtcGetBufferData(buffer));
    // No NaN may reach Embree, whoever made the geometry.
    for (const glm::vec3& p : world.positions)
      *vertex++ = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? p : glm::vec3{0.0f};
    return buffer;
  }

  RTCGeometry make_geometry(const scene::world_geometry& world, const std::vector<std::uint32_t>& polygons,
                            RTCBuffer vertices) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), polygons.size()));
    rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(glm::vec3),
                         world.positions.size());
    check("allocating geometry");
    for (const std::uint32_t polygon : polygons)
      for (std::size_t k = 0; k < 3; ++k) *index++ = world.indices[3 * std::size_t{polygon} + k];
    rtcCommitGeometry(geometry);
    return geometry;
  }

  RTCScene make_scene() const {
    RTCScene made = rtcNewScene(device);
    // Robust: no ray slips between two triangles that share an edge. Never HIGH quality: its spatial splits depend on
    // threads, and a bake has to repeat.
    rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_MEDIUM);
    return made;
  }
};

ray_scene::ray_scene(const scene::world_geometry& geometry, bool all_double_sided)
    : geometry_(geometry), all_double_sided_(all_double_sided), embree_(std::make_unique<embree>()) {
  embree& e = *embree_;
  e.device = rtcNewDevice("isa=avx2");
  if (!e.device) e.device = rtcNewDevice(nullptr);
  if (!e.device) throw std::runtime_error("there is no Embree device");
  std::uint32_t test = 0;
  for (std::uint32_t polygon = 0; polygon < geometry.kinds.size(); ++polygon) {
    const scene::polygon_kind kind = geometry.kinds[polygon];
    if (!kind.absent) e.ids[geometry_of(kind)].push_back(polygon);
    if (!kind.alpha_tested) continue;
    while (test < geometry.masked.size() && geometry.masked[test].id < polygon) ++test;
    if (!kind.absent) e.tests[geometry_of(kind)].push_back(test);
  }
  e.solid = e.make_scene();
  RTCBuffer vertices = e.make_vertices(geometry);
  std::array<RTCGeometry, geometry_count> parts{};
  bool all_hide = true;
  for (unsigned i = 0; i < geometry_count; ++i) {
    if (e.ids[i].empty() && i != opaque_standing) continue;
    parts[i] = e.make_geometry(geometry, e.ids[i], vertices);
    if (hides(i)) rtcAttachGeometryByID(e.solid, parts[i], i);
    all_hide = all_hide && hides(i);
  }
  rtcCommitScene(e.solid);
  e.all = e.solid;
  if (!all_hide) {
    e.all = e.make_scene();
    for (unsigned i = 0; i < geometry_count; ++i)
      if (parts[i]) rtcAttachGeometryByID(e.all, parts[i], i);
    rtcCommitScene(e.all);
  }
  for (const RTCGeometry part : parts)
    if (part) rtcReleaseGeometry(part);
  rtcReleaseBuffer(vertices);
  e.check("building the ray scene");
}

ray_scene::~ray_scene() = default;

look_context ray_scene::embree::context(const ray_scene& rays) const {
  look_context made;
  rtcInitIntersectContext(&made.base);
  made.base.filter = keep_what_occludes;
  made.ids = ids.data();
  made.tests = tests.data();
  made.geometry = &rays.geometry_;
  made.all_double_sided = rays.all_double_sided_;
  return made;
}

void ray_scene::look(const glm::vec3& eye, const glm::vec3& direction, sight& out) const {
  thread_local std::vector<passed_polygon> passed;
  passed.clear();
  look_context context = embree_->context(*this);
  context.passed = &passed;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  RTCRayHit r{.ray = one_ray(eye, direction, 0.0f, infinity), .hit = {}};
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->all, &context.base, &r);

  const bool hit = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  out.front = hit ? embree_->ids[r.hit.geomID][r.hit.primID] : no_polygon;
  out.distance = hit ? r.ray.tfar : infinity;
  // Traversal is not in order of distance: polygons behind the front one may have been noted too, and some twice.
  out.before.clear();
  std::sort(passed.begin(), passed.end(), [](const passed_polygon& a, const passed_polygon& b) {
    return a.polygon != b.polygon ? a.polygon < b.polygon : a.distance < b.distance;
  });
  for (const passed_polygon& p : passed) {
    const bool again = !out.before.empty() && out.before.back().polygon == p.polygon;
    if (p.distance < out.distance && !again) out.before.push_back(p);
  }
}

void ray_scene::embree::collect(look_context& context, const RTCRay& along, std::vector<std::uint32_t>& out) const {
  thread_local std::vector<passed_polygon> passed;
  passed.clear();
  context.passed = &passed;
  context.pass_all = true;
  RTCRayHit r{.ray = along, .hit = {}};
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(all, &context.base, &r);
  out.clear();
  for (const passed_polygon& p : passed) out.push_back(p.polygon);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

void ray_scene::coincident(const glm::vec3& eye, const glm::vec3& direction, float distance,
                           std::vector<std::uint32_t>& out) const {
  look_context context = embree_->context(*this);
  const float reach = coincidence_reach(distance);
  embree_->collect(context, one_ray(eye, direction, std::max(0.0f, distance - reach), distance + reach), out);
}

void ray_scene::stacked(const glm::vec3& point, const glm::vec3& normal, float reach,
                        std::vector<std::uint32_t>& out) const {
  look_context context = embree_->context(*this);
  context.all_double_sided = true;
  embree_->collect(context, one_ray(point + normal * reach, -normal, 0.0f, 2.0f * reach), out);
}

bool ray_scene::through_gap(const glm::vec3& eye, const glm::vec3& direction, float distance,
                            float smallest_gap) const {
  const float blocked_before = distance - std::max(0.02f, 0.01f * distance);
  if (!(smallest_gap > 0.0f) || !(blocked_before > 0.0f)) return false;
  const auto blocked = [&](const glm::vec3& beside) {
    look_context context = embree_->context(*this);
    RTCRay r = one_ray(eye + beside, direction, 0.0f, blocked_before);
    rtcOccluded1(embree_->solid, &context.base, &r);
    return r.tfar < 0.0f;  // Embree's mark for a hit
  };
  // Along the horizon first: most cracks stand or lie.
  const glm::vec3 up = std::abs(direction.y) < 0.999f ? glm::vec3{0.0f, 1.0f, 0.0f} : glm::vec3{1.0f, 0.0f, 0.0f};
  const glm::vec3 across = glm::normalize(glm::cross(direction, up)), along = glm::cross(across, direction);
  constexpr float half_root = 0.70710678f;
  for (const glm::vec3& side : {across, along, (across + along) * half_root, (across - along) * half_root}) {
    const glm::vec3 beside = side * smallest_gap;
    if (blocked(beside) && blocked(-beside)) return true;
  }
  return false;
}

bool ray_scene::touches_surface(const glm::vec3& point, float radius) const {
  RTCPointQuery query{};
  query.x = point.x, query.y = point.y, query.z = point.z, query.time = 0.0f, query.radius = radius;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  nearness near{&geometry_, embree_->ids.data()};
  rtcPointQuery(embree_->all, &query, &context, note_touch, &near);
  return near.touched;
}

// Walls are modeled as two single-sided layers back to back, too: which of them a ray meets first is chance, and their
// backs say nothing.
bool ray_scene::has_front(const glm::vec3& point, const glm::vec3& direction, float distance) const {
  look_context context = embree_->context(*this);
  const float reach = coincidence_reach(distance);
  RTCRay r = one_ray(point, direction, std::max(0.0f, distance - reach), distance + reach);
  rtcOccluded1(embree_->solid, &context.base, &r);
  return r.tfar < 0.0f;
}

// Packets of eight neighboring points along one direction: parallel rays from near places take the same way through
// the tree, which makes the 64 rays of a place several times cheaper than one by one.
void ray_scene::find_solid(std::span<const glm::vec3> points, std::span<std::uint8_t> solid) const {
  // Nobody is single-sided then: whoever asks for it has windings that say nothing.
  if (all_double_sided_) {
    std::fill(solid.begin(), solid.end(), std::uint8_t{0});
    return;
  }
  for (std::size_t first = 0; first < points.size(); first += packet) {
    const std::size_t count = std::min(packet, points.size() - first);
    alignas(32) int valid[packet];
    std::array<int, packet> hits{}, backs{};
    for (std::size_t i = 0; i < packet; ++i) valid[i] = i < count ? -1 : 0;
    std::size_t undecided = count;
    for (std::size_t k = 0; k < solid_directions && undecided > 0; ++k) {
      const glm::vec3& direction = fixed_directions()[k];
      RTCRayHit8 r = parallel_rays(points.subspan(first, count), direction);
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect8(valid, embree_->solid, &context, &r);
      const int left = static_cast<int>(solid_directions - k - 1);
      for (std::size_t i = 0; i < count; ++i) {
        if (valid[i] == 0 || r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        ++hits[i];
        const scene::polygon_kind kind = geometry_.kinds[embree_->ids[r.hit.geomID[i]][r.hit.primID[i]]];
        const glm::vec3 normal{r.hit.Ng_x[i], r.hit.Ng_y[i], r.hit.Ng_z[i]};
        const bool votes = kind.alpha == scene::alpha_mode::opaque && !kind.double_sided;
        if (votes && glm::dot(normal, direction) > 0.0f && !has_front(points[first + i], direction, r.ray.tfar[i]))
          ++backs[i];
        // Even if all that is left hit fronts, it would be a solid: seven directions do for most places inside one.
        if (10 * backs[i] > hits[i] + left) valid[i] = 0, --undecided;
      }
    }
    for (std::size_t i = 0; i < count; ++i) solid[first + i] = 10 * backs[i] > hits[i] ? 1 : 0;
  }
}

void ray_scene::find_free(std::span<const glm::vec3> points, float radius, std::span<std::uint8_t> free) const {
  std::vector<glm::vec3> clear;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < points.size(); ++i) {
    free[i] = 0;
    if (touches_surface(points[i], radius)) continue;
    clear.push_back(points[i]);
    which.push_back(i);
  }
  std::vector<std::uint8_t> solid(clear.size());
  find_solid(clear, solid);
  for (std::size_t i = 0; i < which.size(); ++i) free[which[i]] = solid[i] ? 0 : 1;
}

bool ray_scene::is_free(const glm::vec3& point, float radius) const {
  std::uint8_t free = 0;
  find_free({&point, 1}, radius, {&free, 1});
  return free != 0;
}

}  // namespace sightcell::bake
