#pragma once
// The space that the rays and hemicubes of one step of a cell passed through: rays as nested grids of bits around the
// cell, hemicubes as depths of blocks of pixels.
// A polygon that meets none of it can change nothing in the step (docs/method/incremental.md).
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/base/box.h"
#include "touched/touched_faces.h"

namespace sightcell::bake {

// Level k is a cube around the middle of the cell with 64 x 64 x 64 voxels, twice as wide as level k - 1. A line is
// marked in the smallest cube that contains its part, so voxels are a 32nd to a 16th of the distance wide.
// Used by one thread at a time.
class touched_space {
 public:
  static constexpr int side = 64;  // voxels
  // Returns the side of the blocks in which hemicubes of this resolution are marked, in pixels: 1, 2, 4 or 8.
  static std::uint32_t block_of(std::uint32_t resolution);

  // cell: the grown box of the cell, from which all lines begin. scene: the box of the scene; the cubes reach to its
  // farthest corner.
  touched_space(const box& cell, const box& scene);

  // Marks from + t * direction for t in 0 .. length, which may be infinite. direction: of any length.
  void mark_line(const glm::vec3& from, const glm::vec3& direction, float length);
  void mark_box(const glm::vec3& min, const glm::vec3& max);
  // Adds a face of a hemicube, as touched_faces::add().
  std::span<std::uint8_t> mark_face(const touched_face& face) { return faces_.add(face); }

  // Returns false if no line passed within `near` meters of the triangle and no pixel sees it. May return true where
  // none did, up to about one voxel away from lines, and as touched_faces::meets() does.
  bool meets(const std::array<glm::vec3, 3>& corners, float near) const;
  // The same for a box.
  bool meets(const box& where, float near) const;

  // Adds what another space of the same cell has. The box of the scene may be another one.
  void add(const touched_space& other);

  // Returns the bytes: the place of the cubes, then their bits and the faces, deflated.
  std::vector<std::uint8_t> encode() const;
  // The reverse. The bytes may be arbitrary. Returns nothing if they are not those of encode().
  static std::optional<touched_space> decode(std::span<const std::uint8_t> bytes);

 private:
  static constexpr int most_levels = 40;
  static constexpr std::size_t rows_of_level = std::size_t{side} * side;

  struct plane {
    glm::vec3 normal{0.0f};  // of any length; 0: none
    float offset = 0.0f;     // dot(normal, point)
  };
  touched_space() = default;
  float half_of(int level) const;
  void walk(int level, const glm::dvec3& first, const glm::dvec3& last);
  bool meets(const box& where, float near, const plane& cut) const;
  bool meets(int level, const box& polygon, float by, const plane& cut) const;

  glm::vec3 middle_{0.0f};
  float half_ = 1.0f;  // meters, half of the width of the cube of level 0
  int levels_ = 1;
  bool escapes_ = false;             // a line left the largest cube
  std::vector<std::uint64_t> rows_;  // 64 x 64 per level, by z, then y; a bit per x
  touched_faces faces_;
};

// The space that is recorded on this thread; null: none. Rays and hemicubes mark it.
inline thread_local touched_space* recorded_space = nullptr;

// Records on this thread while it exists. space: null for none.
class recording {
 public:
  explicit recording(touched_space* space) : before_(recorded_space) { recorded_space = space; }
  ~recording() { recorded_space = before_; }
  recording(const recording&) = delete;
  recording& operator=(const recording&) = delete;

 private:
  touched_space* before_;
};

}  // namespace sightcell::bake
