#pragma once
// The colors behind the pixels of a hemicube, whichever source drew it: a hemicube_image says which polygon a pixel
// shows, and where on it follows from pose and pixel alone.
//
// A color is the unlit base color of sightcell::picture: texture (sRGB, bilinear in linear light, the material's wrap
// modes) x base color factor x vertex color, as sRGB bytes; where there is no polygon, the picture's sky. There is no
// mip-mapping: far textures are sampled in a point and show more noise than a picture. Light and haze are left out, and
// so are polygons that hide nothing: they are not in the image.
#include <cstdint>
#include <glm/ext/vector_uint3_sized.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

class surface_colors {
 public:
  // Decodes the images that materials use, in parallel on the caller's arena: 4 bytes a texel. What cannot be decoded
  // is white. Both references must outlive the object.
  surface_colors(const scene::scene& s, const scene::world_geometry& world);

  // out: one color per pixel, in the order of the image, which has 3 S x S ids and was drawn from that pose; resized
  // where its size differs. Rows in parallel on the caller's arena, with the same bytes on any. May be called from
  // several threads at a time.
  void color(const pose& where, const hemicube_image& image, std::vector<glm::u8vec3>& out) const;

  // Of one polygon along one line of sight that meets it: what color() gives a pixel whose center lies there. The
  // length of direction does not matter.
  glm::u8vec3 color_of(std::uint32_t polygon, const glm::vec3& eye, const glm::vec3& direction) const;
  // Where there is no polygon.
  static glm::u8vec3 sky();

 private:
  struct surface;  // a polygon as seen from an eye

  surface surface_of(std::uint32_t id, const glm::dvec3& eye) const;
  glm::u8vec3 color_at(const surface& seen, const glm::dvec3& direction) const;

  const scene::scene& scene_;
  const scene::world_geometry& world_;
  std::vector<std::optional<scene::image_pixels>> textures_;  // by image of the scene
};

// Mean |RGB difference| of two pictures of the same size, 0..1; all pixels weigh the same.
double mean_color_difference(std::span<const glm::u8vec3> a, std::span<const glm::u8vec3> b);

}  // namespace sightcell::bake
