#pragma once
// Colors of the pixels of a hemicube, for any source. A hemicube_image has the polygon of each pixel. The point on that
// polygon follows from the pose and the pixel.
//
// A color is the unlit base color of sightcell::picture: texture (sRGB, bilinear in linear light, the material's wrap
// modes) x base color factor x vertex color, as sRGB bytes. The background has the sky color of the picture. There is
// no mip-mapping, so distant textures are noisier than in a picture. Light and haze are left out. Non-occluders have no
// color here, because they are not in the image.
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
  // Decodes the images that materials use, in parallel on the caller's TBB arena, to 4 bytes per texel. An image that
  // cannot be decoded is white. Both references must outlive the object.
  surface_colors(const scene::scene& s, const scene::world_geometry& world);

  // Computes the color of each pixel of an image of 3 S x S ids that was rendered from that pose. out has the order of
  // the image and is resized if needed. Works on rows in parallel on the caller's TBB arena; the result does not depend
  // on the arena. Several threads may call it at a time.
  void color(const pose& where, const hemicube_image& image, std::vector<glm::u8vec3>& out) const;

  // Color of a polygon where a line of sight meets it: the color that color() computes for a pixel in this direction.
  // direction need not be normalized.
  glm::u8vec3 color_of(std::uint32_t polygon, const glm::vec3& eye, const glm::vec3& direction) const;
  // Color of the background.
  static glm::u8vec3 sky();

 private:
  struct surface;  // a polygon relative to an eye

  surface surface_of(std::uint32_t id, const glm::dvec3& eye) const;
  glm::u8vec3 color_at(const surface& seen, const glm::dvec3& direction) const;

  const scene::scene& scene_;
  const scene::world_geometry& world_;
  std::vector<std::optional<scene::image_pixels>> textures_;  // by image of the scene
};

// Mean absolute difference of the channels of two pictures of the same size, 0..1.
double mean_color_difference(std::span<const glm::u8vec3> a, std::span<const glm::u8vec3> b);

}  // namespace sightcell::bake
