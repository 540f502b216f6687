#pragma once
// Triangle meshes under construction, and the few shapes that everything is made of. Meters, +Y up, right-handed;
// front faces are counter-clockwise. "Up order" of a ring of plan points (x, z) is the order in which it faces up.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace sightcell::city {

enum class surface : std::uint8_t {
  plaster_cream,
  plaster_ochre,
  plaster_rose,
  plaster_grey,
  plaster_green,
  plaster_white,
  roof_tile,
  roof_slate,
  stone,
  window,
  glass,
  wood,
  road,
  pavement,
  lawn,
  bark,
  leaves_light,
  leaves_dark,
  metal,
  paint,
  fence,
  // Only in the richer styles:
  brick,
  foliage,  // MASK, double-sided
  litter,   // double-sided
  cloth,    // double-sided
  flower,
  fruit,
  sign_red,
  sign_blue,
  concrete,
  panel_light,  // panels are single sheets in front of a solid
  panel_grey,
  panel_rose,
  panel_dark,
  rust,
  count
};

inline constexpr std::size_t plain_surface_count = static_cast<std::size_t>(surface::fence) + 1;

using ring = std::array<glm::dvec2, 4>;  // a convex quadrilateral in plan, in up order

struct primitive {
  surface material = surface::stone;
  std::vector<std::array<float, 3>> positions;
  std::vector<std::uint32_t> indices;
};

class mesh {
 public:
  explicit mesh(std::string name, const glm::dvec3& origin = {0, 0, 0}) : name_(std::move(name)), origin_(origin) {}

  const std::string& name() const { return name_; }
  const glm::dvec3& origin() const { return origin_; }  // where its node puts it; points are given in the city's space
  const std::vector<primitive>& primitives() const { return primitives_; }
  std::uint64_t polygon_count() const;

  void triangle(surface material, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  void quad(surface material, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

  // A closed box of 12 polygons around center; ax, ay, az: half edges, right-handed.
  void box(surface material, const glm::dvec3& center, const glm::dvec3& ax, const glm::dvec3& ay,
           const glm::dvec3& az);
  void upright_box(surface material, const glm::dvec3& low, const glm::dvec3& high);

  // A closed prism of 12 polygons over a ring.
  void prism(surface material, const ring& base, double low, double high);

  // A closed six-sided frustum of 20 polygons; a top radius of 0 gives a cone of 10.
  void column(surface material, const glm::dvec3& base, double bottom_radius, double top_radius, double height);

  // A closed blob: an icosahedron, its faces split in four where fine (20 or 80 polygons), its corners moved in and out
  // by up to a quarter of the radius as seed says.
  void blob(surface material, const glm::dvec3& center, const glm::dvec3& radius, bool fine, std::uint64_t seed);

 private:
  primitive& of(surface material);

  std::string name_;
  glm::dvec3 origin_;
  std::vector<primitive> primitives_;
};

glm::dvec3 at_height(const glm::dvec2& plan, double y);
glm::dvec2 unit_vector(const glm::dvec2& v);

// Outward for an edge a-b of a ring in up order.
glm::dvec2 outward_normal(const glm::dvec2& a, const glm::dvec2& b);

// Every edge k moved inward by distance[k].
ring inset(const ring& r, const std::array<double, 4>& distance);
glm::dvec2 centroid(const ring& r);
bool overlap(const ring& a, const ring& b);

}  // namespace sightcell::city
