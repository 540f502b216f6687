#include "agreement/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>

#include "hemicube/hemicube_faces.h"
#include "sightcell/scene/scene.h"
#include "trace/triangle_math.h"

namespace sightcell::test {
namespace {

constexpr std::size_t odd_limit = 1000;
constexpr double edge_width = 0.01;
constexpr std::array<double, 2> rings{edge_width, 0.003};  // pixels; the inner one for polygons that end between
constexpr std::array<double, 7> wider_rings{0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0};
constexpr int ring_rays = 16;

// A pixel in the image of its face.
struct image_place {
  bake::face_view face;
  std::uint32_t left = 0, low = 0;
};

image_place place_of(const bake::pose& from, std::uint32_t resolution, std::uint32_t pixel) {
  const std::uint32_t column = pixel % (3 * resolution), row = pixel / (3 * resolution);
  for (const bake::face_view& f : bake::hemicube_faces(from, resolution)) {
    if (column >= f.x && column < f.x + f.width && row >= f.y && row < f.y + f.height)
      return {f, column - f.x, row - f.y};
  }
  throw std::logic_error("no face has this pixel");
}

// Through a place beside a pixel's center, in pixels; doubles, because 1/100 pixel is little.
glm::vec3 direction_beside(const bake::pose& from, std::uint32_t resolution, std::uint32_t pixel, double x, double y) {
  const auto [f, left, low] = place_of(from, resolution, pixel);
  const double a = f.min_x + (left + 0.5 + x) / f.width * (f.max_x - f.min_x);
  const double b = f.min_y + (low + 0.5 + y) / f.height * (f.max_y - f.min_y);
  return glm::vec3(glm::normalize(glm::dvec3(f.forward) + a * glm::dvec3(f.right) + b * glm::dvec3(f.up)));
}

// Right, up and forward of a face, meters.
glm::dvec3 in_frame(const bake::face_view& face, const glm::vec3& eye, const glm::vec3& point) {
  const glm::dvec3 d = glm::dvec3(point) - glm::dvec3(eye);
  return {glm::dot(d, glm::dvec3(face.right)), glm::dot(d, glm::dvec3(face.up)), glm::dot(d, glm::dvec3(face.forward))};
}

bool sees_there(const bake::ray_scene& rays, const glm::vec3& eye, const glm::vec3& direction, std::uint32_t polygon) {
  thread_local bake::sight seen;
  thread_local std::vector<std::uint32_t> same_place;
  rays.trace(eye, direction, seen);
  if (seen.front == polygon || seen.front == bake::no_polygon || polygon == bake::no_polygon)
    return seen.front == polygon;
  rays.coincident(eye, direction, seen.distance, same_place);
  return std::binary_search(same_place.begin(), same_place.end(), polygon);
}

// The first of the rings that meets the polygon; infinite where none does.
double meets(const bake::ray_scene& rays, const bake::pose& from, std::uint32_t resolution, std::uint32_t pixel,
             std::uint32_t polygon, std::span<const double> radii) {
  for (const double radius : radii) {
    for (int k = 0; k < ring_rays; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / ring_rays;
      const glm::vec3 beside =
          direction_beside(from, resolution, pixel, radius * std::cos(angle), radius * std::sin(angle));
      if (sees_there(rays, from.eye, beside, polygon)) return radius;
    }
  }
  return INFINITY;
}

// Distance in pixels from a pixel's center to the outline of a polygon in its image; infinite where all of it lies
// behind the eye.
double to_outline(const scene::world_geometry& geometry, const bake::pose& from, std::uint32_t resolution,
                  std::uint32_t pixel, std::uint32_t polygon) {
  const image_place at = place_of(from, resolution, pixel);
  const glm::dvec2 center{(at.left + 0.5) / at.face.width * (at.face.max_x - at.face.min_x) + at.face.min_x,
                          (at.low + 0.5) / at.face.height * (at.face.max_y - at.face.min_y) + at.face.min_y};
  const bake::triangle corners = bake::corners_of(geometry, polygon);
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 a = in_frame(at.face, from.eye, corners[static_cast<std::size_t>(k)]);
    glm::dvec3 b = in_frame(at.face, from.eye, corners[static_cast<std::size_t>((k + 1) % 3)]);
    if (a.z < b.z) std::swap(a, b);
    constexpr double near = 1e-6;
    if (a.z <= near) continue;
    if (b.z < near) b = a + (b - a) * ((a.z - near) / (a.z - b.z));
    const glm::dvec2 p = glm::dvec2(a) / a.z, q = glm::dvec2(b) / b.z, along = q - p;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0.0 ? glm::clamp(glm::dot(center - p, along) / length2, 0.0, 1.0) : 0.0;
    least = std::min(least, glm::distance(center, p + t * along) * 0.5 * resolution);
  }
  return least;
}

// Polygons thinner than the ring's rays are apart: the nearer of the two ends at the center, and the other one is
// there.
bool ends_there(const bake::ray_scene& rays, const bake::pose& from, std::uint32_t resolution, const odd_pixel& p) {
  const auto ends = [&](std::uint32_t polygon) {
    return polygon != bake::no_polygon && to_outline(rays.geometry(), from, resolution, p.pixel, polygon) <= edge_width;
  };
  if (p.depth_of_source < p.depth_of_rays) return ends(p.of_source);
  if (!ends(p.of_rays)) return false;
  if (p.of_source == bake::no_polygon || ends(p.of_source)) return true;
  const image_place at = place_of(from, resolution, p.pixel);
  const glm::vec3 direction = direction_beside(from, resolution, p.pixel, 0.0, 0.0);
  std::vector<std::uint32_t> there;
  rays.coincident(from.eye, direction, p.depth_of_source / glm::dot(direction, at.face.forward), there);
  return std::binary_search(there.begin(), there.end(), p.of_source);
}

float depth_of(float inverse) {
  return inverse > 0.0f ? 1.0f / inverse : INFINITY;
}

}  // namespace

static_assert(bake::no_polygon == scene::no_index);

void agreement::add(const agreement& other) {
  pixels += other.pixels;
  different += other.different;
  coincident += other.coincident;
  at_edge += other.at_edge;
  depths += other.depths;
}

agreement compare(const bake::ray_scene& rays, const bake::pose& from, const bake::hemicube_image& of_rays,
                  const bake::hemicube_image& of_source, std::vector<odd_pixel>& odd) {
  agreement found;
  found.pixels = of_rays.ids.size();
  for (std::uint32_t pixel = 0; pixel < of_rays.ids.size(); ++pixel) {
    const std::uint32_t a = of_rays.ids[pixel], b = of_source.ids[pixel];
    const float depth_a = of_rays.inverse_depths[pixel], depth_b = of_source.inverse_depths[pixel];
    if (a == b) {
      if (std::abs(depth_a - depth_b) > 1e-3f * depth_a) ++found.depths;
      continue;
    }
    ++found.different;
    if (a != bake::no_polygon && b != bake::no_polygon &&
        sees_there(rays, from.eye, direction_beside(from, of_rays.resolution, pixel, 0.0, 0.0), b)) {
      ++found.coincident;
      continue;
    }
    odd_pixel p{from, pixel, a, b, depth_of(depth_a), depth_of(depth_b)};
    if (meets(rays, from, of_rays.resolution, pixel, b, rings) < INFINITY ||
        ends_there(rays, from, of_rays.resolution, p)) {
      ++found.at_edge;
    } else if (odd.size() < odd_limit) {
      p.beside = meets(rays, from, of_rays.resolution, pixel, b, wider_rings);
      for (const auto& [polygon, outline] : {std::pair{a, &p.outline_of_rays}, std::pair{b, &p.outline_of_source}})
        if (polygon != bake::no_polygon)
          *outline = to_outline(rays.geometry(), from, of_rays.resolution, pixel, polygon);
      odd.push_back(p);
    }
  }
  return found;
}

}  // namespace sightcell::test
