#include "file/texture_levels.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <limits>

#include "sightcell/format/residency_table.h"

namespace sightcell::bake {
namespace {

constexpr double not_needed = std::numeric_limits<double>::infinity();

glm::dvec2 texel_at(const std::vector<glm::vec2>& uvs, std::size_t vertex, const scene::texture_use& use,
                    const glm::dvec2& size) {
  // Without texture coordinates, all corners have the same texel.
  return vertex < uvs.size() ? use.transform * glm::dvec2(uvs[vertex]) * size : glm::dvec2(0.0);
}

// The plane of a polygon, for the heights of eyes above it.
struct polygon_plane {
  glm::dvec3 normal{0.0};  // unit vector on the side of the front; 0 without area
  double offset = 0.0;

  explicit polygon_plane(const triangle& t) {
    const glm::dvec3 a(t[0]), across = glm::cross(glm::dvec3(t[1]) - a, glm::dvec3(t[2]) - a);
    const double length = glm::length(across);
    if (!(length > 0.0) || !std::isfinite(length)) return;
    normal = across / length;
    offset = glm::dot(normal, a);
  }
  // Returns the greatest height of a point of the box in front; behind it too, if the polygon has two sides.
  double height_of(const box& b, bool both_sides) const {
    double highest = -offset, lowest = -offset;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = normal[axis] * static_cast<double>(b.min[axis]),
                   high = normal[axis] * static_cast<double>(b.max[axis]);
      highest += std::max(low, high);
      lowest += std::min(low, high);
    }
    return both_sides ? std::max(highest, -lowest) : highest;
  }
};

double distance_of_boxes(const box& a, const box& b) {
  const glm::dvec3 apart = glm::max(glm::dvec3(a.min) - glm::dvec3(b.max), glm::dvec3(b.min) - glm::dvec3(a.max));
  return glm::length(glm::max(apart, glm::dvec3(0.0)));
}

box bounds_of(const triangle& t) {
  return {glm::min(glm::min(t[0], t[1]), t[2]), glm::max(glm::max(t[0], t[1]), t[2])};
}

box bounds_of(std::span<const box> parts) {
  box all = parts.front();
  for (const box& b : parts) all = {glm::min(all.min, b.min), glm::max(all.max, b.max)};
  return all;
}

}  // namespace

texel_density density_of(const triangle& corners, const std::array<glm::dvec2, 3>& texels) {
  const glm::dvec3 a(corners[0]), ab = glm::dvec3(corners[1]) - a, ac = glm::dvec3(corners[2]) - a;
  // Axes in the plane: x along the first edge.
  const double length = glm::length(ab);
  const double height = glm::length(glm::cross(ab, ac)) / length;
  const double along = glm::dot(ac, ab) / length;
  const glm::dvec2 first = (texels[1] - texels[0]) / length;
  const glm::dvec2 second = (texels[2] - texels[0] - along * first) / height;
  // Singular values of the matrix with these columns.
  const double squares = glm::dot(first, first) + glm::dot(second, second);
  const double area = std::abs(first.x * second.y - first.y * second.x);
  const double most = 0.5 * (std::sqrt(squares + 2.0 * area) + std::sqrt(std::max(squares - 2.0 * area, 0.0)));
  const double least = most > 0.0 ? area / most : 0.0;
  const texel_density density{static_cast<float>(most), static_cast<float>(least)};
  return std::isfinite(density.most) && std::isfinite(density.least) ? density : texel_density{};
}

// Let s be the angle between pixels, d the distance, c the cosine between ray and normal, and p and q the greatest and
// least texels per meter. A pixel covers s d on the polygon, and s d / c in the direction in which it tilts. So the
// squares of the texels between a pixel and its two neighbors add up to (s d)^2 (p^2 + (q / c)^2) or more, of which the
// longer step has a half or more, and the shorter step is s d q or more. A filter without anisotropy takes the level of
// the longer one, one with the anisotropy n that of the shorter one, or of an n-th of the longer one if that is more.
double texels_per_radian(const texel_density& density, double distance, double height, double anisotropy) {
  const double slant = std::max(distance / height, 1.0);  // 1 / c, or less
  const auto p = static_cast<double>(density.most), q = static_cast<double>(density.least);
  const double longer = std::sqrt(0.5 * (p * p + q * q * slant * slant));
  return distance * std::max(q, longer / anisotropy);
}

std::uint8_t level_number(double texels, std::uint8_t coarsest) {
  if (texels == not_needed) return format::no_level;
  const double number = format::level_zero + std::floor(format::quarters_of_level * std::log2(texels));
  return static_cast<std::uint8_t>(
      std::clamp(number, static_cast<double>(format::finest_level), static_cast<double>(coarsest)));
}

texture_levels::texture_levels(const scene::scene& s, const ray_scene& rays, float player_radius, double anisotropy)
    : rays_(rays),
      keep_off_(0.999 * static_cast<double>(player_radius)),  // viewpoints are tested in single precision
      anisotropy_(anisotropy),
      textures_(s.textures.textures.size()) {
  for (const scene::draw& d : s.draws) add_draw(s, d);
}

void texture_levels::add_draw(const scene::scene& s, const scene::draw& d) {
  if (d.material == scene::no_index || d.material >= s.textures.of_material.size() || d.polygon_count == 0) return;
  const std::vector<scene::texture_use>& uses = s.textures.of_material[d.material];
  if (uses.empty()) return;
  draws_.push_back({d.first_source, d.polygon_count, densities_.size(), uses, d.moves});
  static const std::vector<glm::vec2> none;
  const auto sets = s.textures.coordinates.find({d.mesh, d.primitive});
  const auto set_of = [&](std::uint32_t number) -> const std::vector<glm::vec2>& {
    if (sets == s.textures.coordinates.end()) return none;
    const auto found = sets->second.find(number);
    return found == sets->second.end() ? none : found->second;
  };
  const scene::world_geometry& world = rays_.geometry();
  for (std::uint32_t polygon = d.first_source; polygon < d.first_source + d.polygon_count; ++polygon) {
    const triangle corners = corners_of(world, polygon);
    for (const scene::texture_use& use : uses) {
      const scene::texture_info& texture = s.textures.textures[use.texture];
      const glm::dvec2 size(texture.width, texture.height);
      std::array<glm::dvec2, 3> texels;
      // Mirrored draws have two corners swapped in world space, so vertices are those of the corners there.
      for (std::size_t k = 0; k < 3; ++k)
        texels[k] = texel_at(set_of(use.set), world.indices[3 * std::size_t{polygon} + k] - d.base_vertex, use, size);
      densities_.push_back(density_of(corners, texels));
    }
  }
}

std::vector<double> texture_levels::texels_of(const viewpoint_region& region,
                                              std::span<const std::uint32_t> polygons) const {
  std::vector<double> least(textures_, not_needed);
  const std::vector<box> parts = region.parts();
  if (parts.empty()) return least;
  const box whole = bounds_of(parts);
  auto draw = draws_.begin();
  for (const std::uint32_t polygon : polygons) {
    while (draw != draws_.end() && polygon >= draw->first + draw->count) ++draw;
    if (draw == draws_.end()) break;
    if (polygon >= draw->first) add_polygon(*draw, polygon, whole, parts, least);
  }
  return least;
}

void texture_levels::add_polygon(const textured_draw& draw, std::uint32_t polygon, const box& whole,
                                 std::span<const box> parts, std::span<double> least) const {
  if (draw.moves) {  // the host may bring it to any place
    for (const scene::texture_use& use : draw.uses) least[use.texture] = 0.0;
    return;
  }
  const triangle corners = corners_of(rays_.geometry(), polygon);
  const polygon_plane plane(corners);
  if (plane.normal == glm::dvec3(0.0)) return;  // without area, it is in no picture
  const scene::polygon_kind kind = rays_.geometry().kinds[polygon];
  // Valid viewpoints keep the player radius from obstacles.
  const double nearest = kind.absent || kind.non_occluder ? 0.0 : keep_off_;
  const bool both_sides = rays_.sees_both_sides(polygon);
  const box around = bounds_of(corners);
  const std::size_t first = draw.densities + (polygon - draw.first) * draw.uses.size();
  const auto improves = [&](double distance, double height) {
    for (std::size_t i = 0; i < draw.uses.size(); ++i)
      if (texels_per_radian(densities_[first + i], distance, height, anisotropy_) < least[draw.uses[i].texture])
        return true;
    return false;
  };
  // Most polygons change nothing, as a rough bound shows.
  const double highest = plane.height_of(whole, both_sides);
  if (!(highest > 0.0) || !improves(std::max(distance_of_boxes(whole, around), nearest), highest)) return;
  for (const box& part : parts) {
    const double height = plane.height_of(part, both_sides);
    if (!(height > 0.0)) continue;
    if (!improves(std::max(distance_of_boxes(part, around), nearest), height)) continue;
    const double distance = std::max(least_distance(corners, part.min, part.max), nearest);
    for (std::size_t i = 0; i < draw.uses.size(); ++i) {
      double& texels = least[draw.uses[i].texture];
      texels = std::min(texels, texels_per_radian(densities_[first + i], distance, height, anisotropy_));
    }
  }
}

}  // namespace sightcell::bake
