#pragma once
// What a sampler looks through: one hemicube at a pose, answered with the polygons it sees.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
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
  // Sum of the pixel importance I_p (docs/method/samplers.md) over the five faces, in image axes, positive parts
  // only.
  std::array<double, 4> importance{};
};

// The pixels behind a view, for comparing sources: 3 S x S of the atlas (hemicube_faces.h), row by row from its lower
// left. Polygons that hide nothing are not in it.
struct hemicube_image {
  std::uint32_t resolution = 0;
  std::vector<std::uint32_t> ids;     // source id of the front occluding polygon, or scene::no_index
  std::vector<float> inverse_depths;  // 1 / depth along the face's axis, 1/m; 0 where there is no polygon
};

// What the parts of one hemicube cost, CPU seconds of the thread that rendered it.
struct sample_split {
  double draw = 0.0;        // from the polygons to the front polygon and depth of every pixel
  double gather = 0.0;      // from pixels to the list of seen polygons; reading back, where that is needed
  double statistics = 0.0;  // the importance sums
};

// A hemicube: front face S x S with a field of view of 90 degrees along forward, and the four half faces toward right,
// left, up and down that complete the half space, S x S/2 each. Near plane at most 1 mm, no far plane.
class hemicube_source {
 public:
  virtual ~hemicube_source() = default;
  // Renders hemicubes, several at once where the source can; views[i] is overwritten with what poses[i] sees, which is
  // the same whatever else is rendered. Both spans have the same size. Throws sightcell::error when the device is lost.
  virtual void render(std::span<const pose> poses, std::span<hemicube_view> views) = 0;
  void render(const pose& where, hemicube_view& view) { render({&where, 1}, {&view, 1}); }
  // The pixels of one hemicube; image is overwritten. Slow: for tests and benchmarks.
  virtual void render_image(const pose& where, hemicube_image& image) = 0;
  // render() of one hemicube that also says what its parts cost; nothing where the source cannot tell. May be slower
  // than render(), and its parts may add up to less: for benchmarks.
  virtual std::optional<sample_split> render_split(const pose& where, hemicube_view& view) {
    render(where, view);
    return std::nullopt;
  }
  // May calls come from several threads at a time? If not, from the thread that made the source, one at a time.
  virtual bool shared() const = 0;
  virtual std::uint32_t resolution() const = 0;  // S
  virtual std::string device() const = 0;        // for progress, report and checkpoint
};

}  // namespace sightcell::bake
