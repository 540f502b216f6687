#pragma once
// The base-color textures of a scene on the device, for whoever draws on a context of their own: the viewer.
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::picture {

class texture_set {
 public:
  // Decodes and uploads the images that materials use, on the current context. What cannot be decoded is white.
  explicit texture_set(const scene::scene& s);
  ~texture_set();
  texture_set(const texture_set&) = delete;
  texture_set& operator=(const texture_set&) = delete;

  // Texture of an image; white for no_index and for broken images.
  unsigned of_image(std::uint32_t image) const;

 private:
  unsigned white_ = 0;
  std::vector<unsigned> textures_;  // by image; 0: white
};

}  // namespace sightcell::picture
