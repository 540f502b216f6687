#include "trace/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "touched/tested_viewpoints.h"
#include "touched/touched_space.h"
#include "trace/direction_code.h"
#include "trace/embree_scene.h"
#include "trace/line_box.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t solid_directions = 64;
constexpr std::size_t packet = 8;  // rays per Embree packet, the width of AVX2
constexpr float infinity = std::numeric_limits<float>::infinity();

// Evenly spread directions (Fibonacci lattice), rotated so that none lies in an axis plane.
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

// Returns the indices of points in an order in which nearby points share packets.
std::vector<std::uint32_t> near_each_other(std::span<const glm::vec3> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  if (points.size() <= packet) return order;
  glm::vec3 min = points[0], max = points[0];
  for (const glm::vec3& p : points) min = glm::min(min, p), max = glm::max(max, p);
  std::vector<std::uint32_t> codes(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) codes[i] = place_code(points[i], min, max - min);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

// Fills `out` from the first occluder and the recorded non-occluders. Embree does not traverse in order of distance, so
// non-occluders behind the first occluder may have been recorded, and some twice. passed is reordered.
void note_front(std::uint32_t front, float distance, std::vector<passed_polygon>& passed, sight& out) {
  out.front = front;
  out.distance = distance;
  out.before.clear();
  std::sort(passed.begin(), passed.end(), [](const passed_polygon& a, const passed_polygon& b) {
    return a.polygon != b.polygon ? a.polygon < b.polygon : a.distance < b.distance;
  });
  for (const passed_polygon& p : passed) {
    const bool again = !out.before.empty() && out.before.back().polygon == p.polygon;
    if (p.distance < distance && !again) out.before.push_back(p);
  }
}

// Records what a ray passed, with the reach of rule 2 behind its end and more for rounding.
void record_line(const glm::vec3& eye, const glm::vec3& direction, float distance) {
  if (recorded_space) recorded_space->mark_line(eye, direction, distance + 2.0f * coincidence_reach(distance));
}

// The source ids of the primitives of a tree.
using ids_of_tree = std::array<std::vector<std::uint32_t>, embree_geometry_count>;

struct nearness {
  const embree_scene* scene;
  const ids_of_tree* ids;
  bool touched = false;
};

// Finds all polygons that a ray meets and that are present under rule 1, occluders and non-occluders.
void collect(const embree_scene& scene, trace_context& context, const RTCRay& along, std::vector<std::uint32_t>& out) {
  thread_local std::vector<passed_polygon> passed;
  passed.clear();
  context.passed = &passed;
  context.pass_all = true;
  RTCRayHit r{.ray = along, .hit = {}};
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene.all, &context.base, &r);
  out.clear();
  for (const passed_polygon& p : passed) out.push_back(p.polygon);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

// Returns a packet with one ray per point, all along direction. SIMD lanes beyond the points repeat the last one.
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

// Clears the SIMD lanes of hits on backs that have a front in the same place. Some walls are modeled as two
// single-sided layers back to back. Which layer a ray hits first is then arbitrary, so such a back is no evidence for a
// solid.
void drop_covered(const embree_scene& scene, const RTCRayHit8& seen, std::span<int> back) {
  if (std::find(back.begin(), back.end(), -1) == back.end()) return;
  trace_context context(scene);
  context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRay8 r = seen.ray;
  for (std::size_t i = 0; i < packet; ++i) {
    const float distance = seen.ray.tfar[i], reach = coincidence_reach(distance);
    r.tnear[i] = std::max(0.0f, distance - reach);
    r.tfar[i] = distance + reach;
  }
  rtcOccluded8(back.data(), scene.solid, &context.base, &r);
  for (std::size_t i = 0; i < packet; ++i)
    if (r.tfar[i] < 0.0f) back[i] = 0;
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
  const std::uint32_t polygon = (*near->ids)[arguments->geomID][arguments->primID];
  const glm::vec3 point{arguments->query->x, arguments->query->y, arguments->query->z};
  const float distance = distance_to_triangle(point, corners_of(near->scene->geometry, polygon));
  if (distance >= arguments->query->radius) return false;
  near->touched = true;
  arguments->query->radius = 0.0f;  // ends the query: one obstacle is enough
  return true;
}

struct box_query {
  const embree_scene* scene;
  const ids_of_tree* ids;
  glm::vec3 min, max;
  std::vector<std::uint32_t>* found;
};

bool note_in_box(RTCPointQueryFunctionArguments* arguments) {
  const auto& query_data = *static_cast<box_query*>(arguments->userPtr);
  const std::uint32_t polygon = (*query_data.ids)[arguments->geomID][arguments->primID];
  if (triangle_touches_box(corners_of(query_data.scene->geometry, polygon), query_data.min, query_data.max))
    query_data.found->push_back(polygon);
  return false;  // the search radius does not shrink
}

}  // namespace

ray_scene::ray_scene(const scene::world_geometry& geometry, bool all_double_sided, const stop_request* stop)
    : geometry_(geometry),
      all_double_sided_(all_double_sided),
      embree_(std::make_unique<embree_scene>(geometry, all_double_sided, embree_width::avx2, stop)) {}

ray_scene::~ray_scene() = default;

void ray_scene::trace(const glm::vec3& eye, const glm::vec3& direction, sight& out) const {
  trace_context context(*embree_);
  trace(context, eye, direction, out);
}

void ray_scene::trace_both_sides(const glm::vec3& eye, const glm::vec3& direction, sight& out) const {
  trace_context context(*embree_);
  context.all_double_sided = true;
  trace(context, eye, direction, out);
}

void ray_scene::trace(trace_context& context, const glm::vec3& eye, const glm::vec3& direction, sight& out) const {
  thread_local std::vector<passed_polygon> passed;
  passed.clear();
  context.passed = &passed;
  RTCRayHit r{.ray = one_ray(eye, direction, 0.0f, infinity), .hit = {}};
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->all, &context.base, &r);

  const bool hit = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  note_front(hit ? embree_->ids[r.hit.geomID][r.hit.primID] : no_polygon, hit ? r.ray.tfar : infinity, passed, out);
  record_line(eye, direction, out.distance);
}

void ray_scene::trace(std::span<const sight_line> lines, std::span<sight> out) const {
  // Ids that the filter of the MASK geometry ignores; it acts only on rays with id ray_tests_masks.
  constexpr unsigned first_id = ray_tests_masks + 1;
  thread_local std::array<std::vector<passed_polygon>, packet> passed;
  trace_context context(*embree_);
  context.passed = passed.data();
  context.first_id = first_id;
  for (std::size_t first = 0; first < lines.size(); first += packet) {
    const std::size_t count = std::min(packet, lines.size() - first);
    alignas(32) int valid[packet];
    RTCRayHit8 r{};
    for (std::size_t i = 0; i < packet; ++i) {
      const sight_line& line = lines[first + std::min(i, count - 1)];
      valid[i] = i < count ? -1 : 0;
      r.ray.org_x[i] = line.eye.x, r.ray.org_y[i] = line.eye.y, r.ray.org_z[i] = line.eye.z;
      r.ray.dir_x[i] = line.direction.x, r.ray.dir_y[i] = line.direction.y, r.ray.dir_z[i] = line.direction.z;
      r.ray.tfar[i] = infinity;
      r.ray.mask[i] = ~0u;
      r.ray.id[i] = first_id + static_cast<unsigned>(i);
      r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      passed[i].clear();
    }
    rtcIntersect8(valid, embree_->all, &context.base, &r);
    for (std::size_t i = 0; i < count; ++i) {
      const bool hit = r.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      note_front(hit ? embree_->ids[r.hit.geomID[i]][r.hit.primID[i]] : no_polygon, hit ? r.ray.tfar[i] : infinity,
                 passed[i], out[first + i]);
      record_line(lines[first + i].eye, lines[first + i].direction, out[first + i].distance);
    }
  }
}

std::uint32_t ray_scene::front_of_set(const glm::vec3& eye, const glm::vec3& direction,
                                      const std::function<bool(std::uint32_t)>& contains) const {
  trace_context context(*embree_);
  context.only = &contains;
  RTCRayHit r{.ray = one_ray(eye, direction, 0.0f, std::numeric_limits<float>::infinity()), .hit = {}};
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->solid, &context.base, &r);
  record_line(eye, direction, r.ray.tfar);
  return r.hit.geomID != RTC_INVALID_GEOMETRY_ID ? embree_->ids[r.hit.geomID][r.hit.primID] : no_polygon;
}

void ray_scene::trace_against_set(const glm::vec3& eye, const glm::vec3& direction,
                                  const std::function<bool(std::uint32_t)>& contains, sight& out) const {
  trace_context context(*embree_);
  context.only = &contains;
  trace(context, eye, direction, out);
}

void ray_scene::coincident(const glm::vec3& eye, const glm::vec3& direction, float distance,
                           std::vector<std::uint32_t>& out) const {
  trace_context context(*embree_);
  record_line(eye, direction, distance);
  const float reach = coincidence_reach(distance);
  collect(*embree_, context, one_ray(eye, direction, std::max(0.0f, distance - reach), distance + reach), out);
}

void ray_scene::stacked(const glm::vec3& point, const glm::vec3& normal, float reach,
                        std::vector<std::uint32_t>& out) const {
  trace_context context(*embree_);
  context.all_double_sided = true;
  collect(*embree_, context, one_ray(point + normal * reach, -normal, 0.0f, 2.0f * reach), out);
}

bool ray_scene::through_gap(const glm::vec3& eye, const glm::vec3& direction, float distance,
                            float smallest_gap) const {
  const float blocked_before = distance - std::max(0.02f, 0.01f * distance);
  if (!(smallest_gap > 0.0f) || !(blocked_before > 0.0f)) return false;
  record_line(eye, direction, distance);  // for the lines beside it too: they are no farther away than the gap is wide
  const auto blocked = [&](const glm::vec3& beside) {
    trace_context context(*embree_);
    RTCRay r = one_ray(eye + beside, direction, 0.0f, blocked_before);
    rtcOccluded1(embree_->solid, &context.base, &r);
    return r.tfar < 0.0f;  // Embree sets tfar to -infinity on a hit
  };
  // Horizontal and vertical offsets come first, because most gaps are vertical or horizontal.
  const glm::vec3 up = std::abs(direction.y) < 0.999f ? glm::vec3{0.0f, 1.0f, 0.0f} : glm::vec3{1.0f, 0.0f, 0.0f};
  const glm::vec3 across = glm::normalize(glm::cross(direction, up)), along = glm::cross(across, direction);
  constexpr float half_root = 0.70710678f;
  for (const glm::vec3& side : {across, along, (across + along) * half_root, (across - along) * half_root}) {
    const glm::vec3 beside = side * smallest_gap;
    if (blocked(beside) && blocked(-beside)) return true;
  }
  return false;
}

std::vector<std::uint32_t> ray_scene::touching(const glm::vec3& min, const glm::vec3& max) const {
  std::vector<std::uint32_t> found;
  if (recorded_space) recorded_space->mark_box(min, max);
  const glm::vec3 middle = 0.5f * (min + max);
  RTCPointQuery query{};
  query.x = middle.x, query.y = middle.y, query.z = middle.z;
  // The sphere around the box, enlarged for rounding. The exact test follows for each polygon.
  query.radius = 1.001f * 0.5f * glm::distance(min, max) + 1e-4f;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  box_query query_data{embree_.get(), &embree_->ids, min, max, &found};
  rtcPointQuery(embree_->all, &query, &context, note_in_box, &query_data);
  query_data.ids = &embree_->whole_ids;
  for (const RTCScene whole : embree_->whole)
    if (whole) rtcPointQuery(whole, &query, &context, note_in_box, &query_data);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

bool ray_scene::touches_surface(const glm::vec3& point, float radius) const {
  if (recorded_space) recorded_space->mark_box(point - radius, point + radius);
  RTCPointQuery query{};
  query.x = point.x, query.y = point.y, query.z = point.z, query.time = 0.0f, query.radius = radius;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  nearness near{embree_.get(), &embree_->ids};
  rtcPointQuery(embree_->all, &query, &context, note_touch, &near);
  near.ids = &embree_->whole_ids;
  for (const RTCScene whole : embree_->whole)
    if (whole && !near.touched) rtcPointQuery(whole, &query, &context, note_touch, &near);
  return near.touched;
}

// Returns whether the test of a viewpoint can depend on what is in the boxes: a line of find_solid() passes one, or
// the surroundings that touches_surface() looks at meet one.
bool test_passes(const glm::vec3& point, float radius, const edited_boxes& edit) {
  const auto passes = [&](const box& one) {
    const box near = one.grown(radius);
    if (glm::all(glm::lessThanEqual(near.min, point)) && glm::all(glm::lessThanEqual(point, near.max))) return true;
    return std::any_of(fixed_directions().begin(), fixed_directions().end(), [&](const glm::vec3& direction) {
      float enter = 0.0f, leave = std::numeric_limits<float>::max();
      return clip_line(one.min, one.max, point, direction, enter, leave);
    });
  };
  return passes(edit.all) && (edit.parts.empty() || std::any_of(edit.parts.begin(), edit.parts.end(), passes));
}

// Finds the points inside solids: those where more than one in `one_in` of the hits shows a back. Masked polygons hide
// backs, the transparent parts too, and show none.
// Each packet holds one direction from eight nearby points. Parallel rays from nearby origins traverse the same nodes,
// so 64 rays per point cost several times less than one at a time.
void ray_scene::find_solid(std::span<const glm::vec3> points, int one_in, std::span<std::uint8_t> solid) const {
  // A user who sets --all-double-sided has windings that carry no information, so nothing is a solid.
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
      if (RTCScene masked = embree_->whole[tested_standing]) rtcIntersect8(valid, masked, &context, &r);
      const int left = static_cast<int>(solid_directions - k - 1);
      alignas(32) int back[packet]{};
      for (std::size_t i = 0; i < count; ++i) {
        if (valid[i] != 0) record_line(points[first + i], direction, r.ray.tfar[i]);
        if (valid[i] == 0 || r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        ++hits[i];
        if (is_tested(r.hit.geomID[i])) continue;
        const scene::polygon_kind kind = geometry_.kinds[embree_->ids[r.hit.geomID[i]][r.hit.primID[i]]];
        const glm::vec3 normal{r.hit.Ng_x[i], r.hit.Ng_y[i], r.hit.Ng_z[i]};
        const bool votes = kind.alpha == scene::alpha_mode::opaque && !kind.double_sided;
        if (votes && glm::dot(normal, direction) > 0.0f) back[i] = -1;
      }
      drop_covered(*embree_, r, back);
      for (std::size_t i = 0; i < count; ++i) {
        if (valid[i] == 0) continue;
        backs[i] -= back[i];
        // The rest cannot change the result: this is a solid even if all remaining rays hit fronts. Seven directions
        // are enough for most points inside solids.
        if (one_in * backs[i] > hits[i] + left) valid[i] = 0, --undecided;
      }
    }
    for (std::size_t i = 0; i < count; ++i) solid[first + i] = one_in * backs[i] > hits[i] ? 1 : 0;
  }
}

// Solids are tested before distances. Most invalid points are inside solids, and seven rays in packets find that for
// less than the search for the nearest surface costs.
void ray_scene::find_clear(std::span<const glm::vec3> points, float radius, int one_in,
                           std::span<std::uint8_t> clear) const {
  std::vector<std::uint8_t> solid(points.size());
  const std::vector<std::uint32_t> order = near_each_other(points);
  std::vector<glm::vec3> sorted(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = points[order[i]];
  find_solid(sorted, one_in, solid);
  for (std::size_t i = 0; i < order.size(); ++i)
    clear[order[i]] = solid[i] || touches_surface(sorted[i], radius) ? 0 : 1;
}

void ray_scene::find_valid(std::span<const glm::vec3> points, float radius, std::span<std::uint8_t> free) const {
  constexpr int one_in = 10;
  tested_viewpoints* const tested = recorded_viewpoints;
  if (!tested) return find_clear(points, radius, one_in, free);
  std::vector<glm::vec3> left;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<std::uint8_t> before = tested->find(points[i]);
    if (before && !test_passes(points[i], radius, *tested->edit())) {
      free[i] = *before;
      continue;
    }
    left.push_back(points[i]);
    place.push_back(i);
  }
  std::vector<std::uint8_t> of_left(left.size());
  find_clear(left, radius, one_in, of_left);
  for (std::size_t i = 0; i < left.size(); ++i) free[place[i]] = of_left[i];
  for (std::size_t i = 0; i < points.size(); ++i) tested->add(points[i], free[i]);
}

bool ray_scene::is_valid(const glm::vec3& point, float radius) const {
  std::uint8_t free = 0;
  find_valid({&point, 1}, radius, {&free, 1});
  return free != 0;
}

bool ray_scene::is_nearly_valid(const glm::vec3& point, float radius) const {
  std::uint8_t clear = 0;
  find_clear({&point, 1}, radius, 4, {&clear, 1});
  return clear != 0;
}

}  // namespace sightcell::bake
