#pragma once
// Textured pictures of a scene, drawn offscreen: all of it, or only the polygons of a cell set, and the difference of
// two pictures. Colors are base colors without light. gl_context.h has the conventions.
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"

namespace sightcell::picture {

// ---- Pictures -------------------------------------------------------------------------------------------------------

// The color of pixels without a polygon, linear.
inline constexpr glm::vec3 sky_color(0.36f, 0.55f, 0.82f);

struct camera {
  glm::vec3 eye{0.0f};                   // meters, world space
  glm::vec3 forward{0.0f, 0.0f, -1.0f};  // of any length above 0
  glm::vec3 up{0.0f, 1.0f, 0.0f};
  float vertical_fov = 1.2f;  // radians, below 3.1
};

struct image_rgba {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // 4 * width * height bytes, rows from the top
};

// ---- Drawing --------------------------------------------------------------------------------------------------------

class renderer {
 public:
  // Uploads geometry and textures.
  // context, s, geometry: must outlive the renderer; the context must be current in all calls.
  // Fails with gl.*.
  renderer(const gl_context& context, const scene::scene& s, const scene::world_geometry& geometry);
  ~renderer();
  renderer(const renderer&) = delete;
  renderer& operator=(const renderer&) = delete;

  // Draws a picture.
  // width, height: pixels; the device has a limit.
  // source_ids: the polygons to draw, ascending; nothing for all of them.
  // Fails with picture.camera, picture.size, picture.no-such-polygon, gl.*.
  image_rgba draw(const camera& view, std::uint32_t width, std::uint32_t height,
                  std::optional<std::span<const std::uint32_t>> source_ids = std::nullopt);

  // Returns the number of polygons in the last draw.
  std::uint64_t polygons_of_last_draw() const;

  // Returns the CPU time of the process during the last draw, until the device had finished.
  double cpu_milliseconds_of_last_draw() const;

 private:
  struct state;
  std::unique_ptr<state> state_;
};

// ---- Comparing and writing ------------------------------------------------------------------------------------------

struct difference {
  std::uint64_t differing_pixels = 0;
  double color_error = 0.0;  // mean difference of RGB over all pixels, 0 .. 1
  image_rgba marked;         // the first picture in gray, differing pixels in red
};

// Compares two pictures of the same size. Fails with picture.size.
difference compare(const image_rgba& a, const image_rgba& b);

// Writes a PNG under another name in the same folder, and renames it.
// Fails with picture.empty, picture.write.
void write_png(const std::filesystem::path& path, const image_rgba& picture);

}  // namespace sightcell::picture
