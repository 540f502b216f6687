#include "stream/tile_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace sightcell::bake {
namespace {

// Of the largest number in the computation of a coordinate. Matrices of nodes and of instances are rounded to this,
// too.
constexpr double rounding = 2e-6;

// The polygons of one geometry in a page.
class local_part {
 public:
  local_part(const scene::gltf_pager& pager, const scene::page_part& part) {
    for (const std::uint32_t polygon : part.polygons)
      if (pager.is_drawn(part.geometry, polygon))
        for (std::uint32_t k = 0; k < 3; ++k) corners_.emplace_back(pager.corner(part.geometry, 3 * polygon + k));
    for (const glm::dvec3& p : corners_) farthest_ = glm::max(farthest_, glm::abs(p));
  }

  // Grows a box by the polygons under a matrix, and returns their area.
  double add(const draw_matrix& m, tile_box& box) const {
    const auto column = [&](std::size_t c) { return glm::dvec3(m[3 * c], m[3 * c + 1], m[3 * c + 2]); };
    const glm::dvec3 x = column(0), y = column(1), z = column(2), origin = column(3);
    const auto place = [&](const glm::dvec3& p) { return x * p.x + y * p.y + z * p.z + origin; };
    tile_box own;
    double area = 0.0;
    for (std::size_t i = 0; i < corners_.size(); i += 3) {
      const glm::dvec3 a = place(corners_[i]), b = place(corners_[i + 1]), c = place(corners_[i + 2]);
      own.min = glm::min(own.min, glm::min(a, glm::min(b, c)));
      own.max = glm::max(own.max, glm::max(a, glm::max(b, c)));
      area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    const double margin = rounding * (glm::length(x) * farthest_.x + glm::length(y) * farthest_.y +
                                      glm::length(z) * farthest_.z + glm::length(origin));
    box.add({own.min - margin, own.max + margin});
    return area;
  }

  bool is_empty() const { return corners_.empty(); }

 private:
  std::vector<glm::dvec3> corners_;
  glm::dvec3 farthest_{0.0};
};

}  // namespace

tile_shape shape_of(const scene::gltf_pager& pager, const shown_draws& shown, std::span<const scene::page_part> parts) {
  tile_shape out;
  double area = 0.0;
  for (const scene::page_part& part : parts) {
    const local_part polygons(pager, part);
    if (polygons.is_empty()) continue;
    double largest = 0.0;  // draws of one geometry are in different places: what is missing in one of them counts
    for (const std::uint32_t draw : shown.of(part.geometry))
      largest = std::max(largest, polygons.add(shown.matrix_at(shown.place_of(draw)), out.box));
    area += largest;
  }
  out.size = std::sqrt(area);
  return out;
}

}  // namespace sightcell::bake
