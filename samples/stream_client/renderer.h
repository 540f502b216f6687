#pragma once
// Draws what has arrived, without a window, in the colors of sightcell::picture: base colors, lit by the normals of the
// polygons.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "materials.h"
#include "page.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/image.h"

namespace stream_client {

// An instance of a geometry.
struct instance {
  std::uint32_t geometry = 0;
  std::uint32_t material = 0;  // in the list of materials
  std::uint32_t object = 0;    // of levels of detail, no_object for none
  std::uint32_t level = 0;
  float matrix[12] = {};  // column by column
};

inline constexpr std::uint32_t no_object = 0xFFFFFFFFu;

class renderer {
 public:
  // context: must outlive the renderer, and is current in all calls.
  // diagonal: of the scene, meters; for the haze.
  // Fails with gl.*.
  renderer(const sightcell::picture::gl_context& context, std::vector<material> materials,
           std::vector<instance> instances, std::uint32_t geometry_count, float diagonal);
  ~renderer();
  renderer(const renderer&) = delete;
  renderer& operator=(const renderer&) = delete;

  // Pages and images on the device, by their numbers. Adding one again replaces it.
  void add_page(std::uint32_t number, const page& contents);
  void remove_page(std::uint32_t number);
  void add_image(std::uint32_t number, const sightcell::scene::image_pixels& pixels);
  void remove_image(std::uint32_t number);

  // Draws instances with all polygons of their geometries that are on the device. Of an object with levels of detail,
  // the finest level that is shown.
  // shown: a bit for each instance.
  sightcell::picture::image_rgba draw(const sightcell::picture::camera& view, std::uint32_t width, std::uint32_t height,
                                      std::span<const std::uint64_t> shown);

  // Returns the polygons of the last picture.
  std::uint64_t polygons_of_last_draw() const;

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace stream_client
