#pragma once
// The interface of all hemicube sources. A source renders the hemicube of a pose and returns the polygons that are
// visible in it.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightcell::bake {

// Position and orientation of a hemicube. forward, right and up are orthonormal; right = cross(forward, up).
struct pose {
  glm::vec3 eye{0.0f};
  glm::vec3 forward{0.0f, 0.0f, -1.0f}, right{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};
};

struct seen_polygon {
  std::uint32_t id = 0;      // source id
  std::uint32_t pixels = 0;  // pixels of the hemicube that show it, at least 1
  std::uint32_t pixel = 0;   // the first of these in the atlas (hemicube_faces.h), row by row from its lower left
};

// The four components of the importance (docs/method/samplers.md), in this order everywhere.
enum direction : std::uint32_t { toward_right = 0, toward_up = 1, toward_left = 2, toward_down = 3 };

struct hemicube_view {
  std::vector<seen_polygon> seen;  // ascending ids, each once
  // Sum of the pixel importance I_p (docs/method/samplers.md) over the five faces, in image axes, positive parts only.
  std::array<double, 4> importance{};
};

// The pixels of a hemicube: 3 S x S pixels of the atlas (hemicube_faces.h), row by row from its lower left.
// Non-occluders are not in it.
struct hemicube_image {
  std::uint32_t resolution = 0;
  std::vector<std::uint32_t> ids;     // source id of the nearest occluder, or scene::no_index
  std::vector<float> inverse_depths;  // 1 / depth along the face's axis, 1/m; 0 where there is no polygon
};

// Cost of the parts of one hemicube, in CPU seconds of the thread that rendered it.
struct sample_split {
  double draw = 0.0;        // from the polygons to the nearest polygon and the depth of each pixel
  double gather = 0.0;      // from the pixels to the list of visible polygons; includes read-back
  double statistics = 0.0;  // the importance sums
};

// A hemicube covers the half-space in front of a pose: a front face of S x S pixels with a field of view of 90 degrees
// along forward, and four half faces of S x S/2 pixels toward right, left, up and down. The distance of the near plane
// is at most 1 mm. There is no far plane.
// Threads: several may call a source at a time, unless its maker says otherwise.
class hemicube_source {
 public:
  virtual ~hemicube_source() = default;
  // Renders hemicubes, several at a time where the source can. Overwrites views[i] with the polygons visible from
  // poses[i]; the other poses do not change this result. Both spans have the same size. Throws sightcell::error when
  // the device is lost.
  virtual void render(std::span<const pose> poses, std::span<hemicube_view> views) = 0;
  void render(const pose& where, hemicube_view& view) { render({&where, 1}, {&view, 1}); }
  // Renders the pixels of one hemicube and overwrites image. Slower than render().
  virtual void render_image(const pose& where, hemicube_image& image) = 0;
  // Renders one hemicube and measures its parts, for benchmarks. Returns nothing where the source cannot measure them.
  // May be slower than render(); the sum of the parts may be less than the whole.
  virtual std::optional<sample_split> render_split(const pose& where, hemicube_view& view) {
    render(where, view);
    return std::nullopt;
  }
  // Returns the seconds that a device has worked for all callers so far; nothing where the work is CPU time of the
  // calling threads.
  virtual std::optional<double> device_seconds() const { return std::nullopt; }
  virtual std::uint32_t resolution() const = 0;  // S
  virtual std::string device() const = 0;        // its name, for progress messages, report and checkpoint key
};

}  // namespace sightcell::bake
