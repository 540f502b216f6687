#pragma once
// Textured offscreen pictures of a scene: full, with only the polygons of a cell set, and what differs between two.
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

// Where there is no polygon; linear.
inline constexpr glm::vec3 sky_color(0.36f, 0.55f, 0.82f);

struct camera {
  glm::vec3 eye{0.0f};
  glm::vec3 forward{0.0f, 0.0f, -1.0f};  // need not be normalised
  glm::vec3 up{0.0f, 1.0f, 0.0f};
  float vertical_fov = 1.2f;  // radians
};

// RGBA, 8 bits each, rows from the top.
struct image_rgba {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

struct difference {
  std::uint64_t differing_pixels = 0;
  double color_error = 0.0;  // mean |RGB difference|, 0..1
  image_rgba marked;         // first picture in gray, differing pixels in red
};

class renderer {
 public:
  // Uploads geometry and textures. All references must outlive the renderer; the context must be current.
  renderer(const gl_context& context, const scene::scene& s, const scene::world_geometry& geometry);
  ~renderer();
  renderer(const renderer&) = delete;
  renderer& operator=(const renderer&) = delete;

  // Draws the polygons with these source ids (ascending), or all of them when there is no list.
  image_rgba draw(const camera& view, std::uint32_t width, std::uint32_t height,
                  std::optional<std::span<const std::uint32_t>> source_ids = std::nullopt);
  std::uint64_t polygons_of_last_draw() const;
  double cpu_milliseconds_of_last_draw() const;  // CPU time of the process while drawing, until the GPU had finished

 private:
  struct state;
  std::unique_ptr<state> state_;
};

// Compares two pictures of the same size.
difference compare(const image_rgba& a, const image_rgba& b);

// Writes a PNG beside path under a temporary name and renames it. Throws sightcell::error on failure.
void write_png(const std::filesystem::path& path, const image_rgba& picture);

}  // namespace sightcell::picture
