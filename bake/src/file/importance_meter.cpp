#include "file/importance_meter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "cells/lattice.h"
#include "search/aim.h"
#include "sightcell/format/importance_classes.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t most_eyes = 64;
constexpr std::uint64_t most_tries = 4096;  // points that are tested to find them
constexpr std::uint32_t first_rays = 8, most_rays = 256;
constexpr int classes_in_use = 11;                        // besides the last one
constexpr double largest_angle = 2.0 * std::numbers::pi;  // half of all directions, the limit for a triangle

std::uint64_t name_of(const box& grown) {
  std::uint64_t name = 0;
  for (const glm::vec3& corner : {grown.min, grown.max})
    for (int axis = 0; axis < 3; ++axis)
      name = mix(name, std::bit_cast<std::uint32_t>(corner[axis] + 0.0f));  // + 0: -0 becomes 0
  return name;
}

// As solid_angle() of triangle_math.h, in double: in float too few digits are left for far and small polygons, which
// are most of them here.
double angle_of(const triangle& corners, const glm::vec3& eye) {
  const glm::dvec3 from(eye);
  const glm::dvec3 a = glm::dvec3(corners[0]) - from, b = glm::dvec3(corners[1]) - from,
                   c = glm::dvec3(corners[2]) - from;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = std::abs(glm::dot(a, glm::cross(b - a, c - a)));
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la;
  const double angle = 2.0 * std::atan2(volume, below);
  return angle >= 0.0 ? std::min(angle, largest_angle) : 0.0;
}

// Returns the estimate of the visible solid angle. The rays had the solid angles `whole` in sum, and those that hit
// `seen`. Half a hit of one more ray is added, the estimate of a share without prior knowledge, because with few rays
// the shares none and all are too extreme.
double expected_angle(double whole, double seen, std::uint32_t rays) {
  return (seen + 0.5 * whole / rays) / (rays + 1.0);
}

}  // namespace

std::uint8_t importance_class_of(double visible_sr) {
  int power = 0;
  const double share = std::frexp(visible_sr / largest_angle, &power);
  if (!(share > 0.0)) return format::least_important;
  const int number = std::max(-power / 2, 0);
  return number < classes_in_use ? static_cast<std::uint8_t>(number) : format::least_important;
}

importance_meter::importance_meter(const ray_scene& rays, const box& grown, float player_radius, std::uint64_t seed)
    : rays_(rays), seed_(seed), place_(name_of(grown)) {
  random_stream random(seed_, place_, purpose::importance);
  std::uint64_t tries = 0;
  eyes_ = draw_viewpoints(rays_, grown, player_radius, most_eyes, most_tries, random, tries);
  // A cell with hardly any valid viewpoint is measured from any of its points, so that its polygons have some order.
  while (eyes_.size() < first_rays) eyes_.push_back(random.in_box(grown.min, grown.max));
}

bool importance_meter::sees(const sight_line& line, const sight& what, float length, std::uint32_t polygon,
                            std::vector<std::uint32_t>& coincident) const {
  if (what.front == polygon) return true;
  for (const passed_polygon& p : what.before)
    if (p.polygon == polygon) return true;
  // Rule 2: the polygon may coincide with the one that was hit at its distance.
  if (!(std::abs(what.distance - length) <= coincidence_reach(what.distance))) return false;
  rays_.coincident(line.eye, line.direction, what.distance, coincident);
  return std::binary_search(coincident.begin(), coincident.end(), polygon);
}

// Casts eight more rays from as many eyes, none from behind the polygon. Returns the number of hits. Adds the
// polygon's solid angles from these eyes to `whole`, and those of the hits to `seen`.
std::uint32_t importance_meter::cast(std::uint32_t polygon, std::size_t first_eye, std::uint32_t begin,
                                     random_stream& random, scratch& room, double& whole, double& seen) const {
  const triangle corners = corners_of(rays_.geometry(), polygon);
  room.lines.clear();
  room.lengths.clear();
  room.angles.clear();
  for (std::uint32_t i = 0; i < first_rays; ++i) {
    const glm::vec3& eye = eyes_[(first_eye + begin + i) % eyes_.size()];
    const glm::vec3 way = random_point(corners, random) - eye;
    const float length = glm::length(way);
    if (!faces(rays_, polygon, eye) || !(length > 0.0f)) continue;
    room.lines.push_back({eye, way / length});
    room.lengths.push_back(length);
    room.angles.push_back(angle_of(corners, eye));
    whole += room.angles.back();
  }
  if (room.sights.size() < first_rays) room.sights.resize(first_rays);
  const std::span<sight> sights = std::span(room.sights).first(room.lines.size());
  rays_.trace(room.lines, sights);
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (!sees(room.lines[i], sights[i], room.lengths[i], polygon, room.coincident)) continue;
    seen += room.angles[i];
    ++hits;
  }
  return hits;
}

double importance_meter::visible_angle(std::uint32_t polygon, scratch& room) const {
  random_stream random(seed_, place_, purpose::importance, 1, bake::name_of(corners_of(rays_.geometry(), polygon)));
  const std::size_t first_eye = random.bits() % eyes_.size();
  double whole = 0.0, seen = 0.0;
  std::uint32_t rays = 0;
  for (std::uint32_t round = first_rays; rays < most_rays; round = rays) {
    std::uint32_t hits = 0;
    for (std::uint32_t end = rays + round; rays < end; rays += first_rays)
      hits += cast(polygon, first_eye, rays, random, room, whole, seen);
    const double angle = expected_angle(whole, seen, rays);
    if (hits > 0) return angle;
    if (importance_class_of(angle) == format::least_important) break;
  }
  return 0.0;
}

}  // namespace sightcell::bake
