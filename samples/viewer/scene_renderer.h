#pragma once
// Draws index lists of one scene, and outlines of boxes, into an offscreen frame. The window only shows that frame: so
// it has the depth buffer we want (32 bit float, reversed), and a picture of it is sound even when the window is
// hidden.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "controls.h"
#include "draw_lists.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"

namespace viewer {

// An index list on the device and how it is drawn.
class index_list {
 public:
  index_list();
  ~index_list();
  index_list(const index_list&) = delete;
  index_list& operator=(const index_list&) = delete;

  // Replaces the list: write gets mapped device memory of that many indices, to be filled from front to back.
  void fill(std::size_t indices, const std::function<void(std::span<std::uint32_t>)>& write);
  void set_ranges(const draw_groups& groups, std::span<const sightcell_range> ranges);

  unsigned buffer() const { return buffer_; }
  const std::vector<group_stretches>& stretches() const { return stretches_; }
  std::uint64_t polygons() const { return polygons_; }

 private:
  unsigned buffer_ = 0;
  std::vector<group_stretches> stretches_;
  std::uint64_t polygons_ = 0;
};

// An index list with what its polygons are painted with; a = 0: their own colors.
struct painted_list {
  const index_list* list = nullptr;
  glm::vec4 mark{0.0f};
};

struct outline {
  glm::vec3 min, max;
  glm::vec4 color;  // linear, with alpha
};

class scene_renderer {
 public:
  // Uploads vertices and textures; nothing of the scene is needed afterwards but the groups, which must outlive this.
  scene_renderer(const sightcell::scene::scene& s, const sightcell::scene::world_geometry& world,
                 const draw_groups& groups);
  ~scene_renderer();
  scene_renderer(const scene_renderer&) = delete;
  scene_renderer& operator=(const scene_renderer&) = delete;

  // Clears the frame, which gets this size, and aims the camera.
  void begin(const fly_camera& camera, std::uint32_t width, std::uint32_t height);
  // Opaque surfaces of all lists first, then blended ones. Of coincident surfaces the earlier list's is seen.
  void draw(std::span<const painted_list> lists, bool wireframe);
  // Full color where they can be seen, faint behind other things.
  void draw_outlines(std::span<const outline> boxes, float pixels_wide);

  unsigned framebuffer() const;
  sightcell::picture::image_rgba read() const;
  void show_in_window() const;  // copies the frame to the window's own buffer, of the same size

 private:
  struct state;
  std::unique_ptr<state> state_;
};

// Throws sightcell::error when OpenGL has reported an error since the last check.
void check_gl(const char* where);

}  // namespace viewer
