#pragma once
// The base-color textures of a scene on the device, for code that draws on a context of its own. gl_context.h has the
// conventions.
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::picture {

class texture_set {
 public:
  // Decodes and uploads the images that materials use, on the current context. An image that cannot be decoded is
  // white. s: used during the constructor only.
  explicit texture_set(const scene::scene& s);

  // Deletes the textures; the same context must be current.
  ~texture_set();
  texture_set(const texture_set&) = delete;
  texture_set& operator=(const texture_set&) = delete;

  // Returns the OpenGL name of the base-color texture of a material, with its wrap modes; a white one for a material
  // without a texture.
  // m: of the scene.
  unsigned of_material(const scene::material& m) const;

 private:
  using key = std::tuple<std::uint32_t, scene::wrap, scene::wrap>;  // image and wrap modes
  unsigned white_ = 0;
  std::vector<unsigned> textures_;   // by image; 0: white
  std::map<key, unsigned> wrapped_;  // images with wrap modes other than repeat
};

}  // namespace sightcell::picture
