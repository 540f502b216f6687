#pragma once
// The base-color textures of a scene on the device, for whoever draws on a context of their own: the viewer.
#include <cstdint>
#include <map>
#include <tuple>
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

  // The base-color texture of a material of the scene, with its wrap modes; white where there is none.
  unsigned of_material(const scene::material& m) const;

 private:
  using key = std::tuple<std::uint32_t, scene::wrap, scene::wrap>;  // image and wrap modes
  unsigned white_ = 0;
  std::vector<unsigned> textures_;   // by image; 0: white
  std::map<key, unsigned> wrapped_;  // the same pixels under other wrap modes than repeat
};

}  // namespace sightcell::picture
