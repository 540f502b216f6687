#pragma once
// How far the pixels of hemicubes see, face by face: the farthest depth of each block of pixels. A polygon that is
// behind all of that can change no pixel (docs/method/incremental.md).
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/base/box.h"

namespace sightcell::bake {

// Where the blocks of a face are. The point eye + z * (forward + a * right + b * up) is at (a, b) in its image plane.
struct touched_face {
  glm::vec3 eye{0.0f}, right{0.0f}, up{0.0f}, forward{0.0f};
  float min_x = 0.0f, min_y = 0.0f;  // the corner of the first block in the image plane
  float step = 1.0f;                 // side of a block there
  float reach = 0.5f;                // of a block's pixels from its middle, with what the rasterizer rounds
  std::uint32_t columns = 0, rows = 0;
};

// Used by one thread at a time.
class touched_faces {
 public:
  // Adds a face. Returns the place for the codes of its blocks (code_of), row by row, which are 0 before: without end.
  // It is valid until the next call.
  std::span<std::uint8_t> add(const touched_face& face);

  // Adds the faces of another one.
  void add(const touched_faces& other);

  // Returns the code of a block whose farthest pixel has this depth (1 / meters along forward, 0 for the background).
  // Codes are 16 per octave of depth and stand for a depth that is larger, by up to 7 % and by more than the reach of
  // rule 2, up to which non-occluders count. Depths below 0.07 m count as that, those above 4 km as without end.
  static std::uint8_t code_of(float inverse_depth);

  // Returns false if no part of the triangle is in front of the farthest pixel of its block. May return true for one
  // that no pixel shows: up to half a pixel beside the blocks, and in front of a block's farthest pixel only.
  bool meets(const std::array<glm::vec3, 3>& corners) const;
  // The same for a box.
  bool meets(const box& where) const;

  std::vector<std::uint8_t> encode() const;
  // The reverse. The bytes may be arbitrary. Returns nothing if they are not those of encode().
  static std::optional<touched_faces> decode(std::span<const std::uint8_t> bytes);

 private:
  std::vector<touched_face> faces_;
  std::vector<std::uint8_t> codes_;  // of all faces, one after the other
};

}  // namespace sightcell::bake
