#pragma once
// What a sampler looks through: one hemicube at a pose, answered with the polygons it sees.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace sightcell::bake {

// Where a hemicube stands. forward, right, up are orthonormal and right = cross(forward, up).
struct pose {
  glm::vec3 eye{0.0f};
  glm::vec3 forward{0.0f, 0.0f, -1.0f}, right{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};
};

struct seen_polygon {
  std::uint32_t id = 0;      // source id
  std::uint32_t pixels = 0;  // pixels of the hemicube it covers, at least 1
  std::uint32_t pixel = 0;   // one of them: the first of the atlas (hemicube_faces.h), row by row from its lower left
};

// The four components of the thesis's importance, in this order everywhere.
enum direction : std::uint32_t { toward_right = 0, toward_up = 1, toward_left = 2, toward_down = 3 };

struct hemicube_view {
  std::vector<seen_polygon> seen;  // ascending ids, each once
  // Sum of the pixel importance I_p (thesis; design.md section 5) over the five faces, in image axes, positive parts
  // only.
  std::array<double, 4> importance{};
};

// A hemicube: front face S x S with a field of view of 90 degrees along forward, and the four half faces toward right,
// left, up and down that complete the half space, S x S/2 each. Near plane at most 1 mm, no far plane.
class hemicube_source {
 public:
  virtual ~hemicube_source() = default;
  // Renders one hemicube; view is overwritten. Same pose, same result. Calls come from one thread at a time.
  // Throws sightcell::error when the device is lost.
  virtual void render(const pose& where, hemicube_view& view) = 0;
  virtual std::uint32_t resolution() const = 0;  // S
  virtual std::string device() const = 0;        // for progress, report and checkpoint
};

}  // namespace sightcell::bake
