#pragma once
// Draws index lists of one scene, and lines, into an offscreen frame. The window only shows that frame: so
// it has the depth buffer we want (32 bit float, reversed), and a picture of it is sound even when the window is
// hidden.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "blended_order.h"
#include "controls.h"
#include "draw_lists.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"
#include "view_volume.h"

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
  void set_ranges(std::span<const sightcell_range> ranges);
  // Draws what the volume touches, or all of the list if there is no volume.
  void clip(const draw_groups& groups, const polygon_blocks& blocks, const view_volume* volume);

  unsigned buffer() const { return buffer_; }
  const std::vector<group_stretches>& stretches() const { return stretches_; }
  // What is drawn of the list.
  std::span<const list_part> parts() const { return clipped_ ? in_view_ : parts_; }
  std::uint64_t polygons() const { return polygons_; }

 private:
  unsigned buffer_ = 0;
  std::vector<list_part> parts_, in_view_;
  bool clipped_ = false, stretches_are_current_ = false;
  std::vector<group_stretches> stretches_;
  std::uint64_t polygons_ = 0;
};

// An index list with what its polygons are painted with; a = 0: their own colors.
struct painted_list {
  const index_list* list = nullptr;
  glm::vec4 mark{0.0f};
};

class scene_renderer {
 public:
  // Uploads vertices and textures; nothing of the scene is needed afterwards.
  scene_renderer(const sightcell::scene::scene& s, const sightcell::scene::world_geometry& world);
  ~scene_renderer();
  scene_renderer(const scene_renderer&) = delete;
  scene_renderer& operator=(const scene_renderer&) = delete;

  // Clears the frame, which gets this size, and aims the camera.
  void begin(const fly_camera& camera, float brightness, std::uint32_t width, std::uint32_t height);
  // Opaque surfaces of all lists first, then blended ones: runs of `everything`, the list of all polygons. Of
  // coincident surfaces the earlier list's is seen.
  void draw(const draw_groups& groups, std::span<const painted_list> lists, std::span<const blended_run> blended,
            const index_list& everything, bool wireframe);
  // Full color where they can be seen, faint behind other things.
  void draw_lines(std::span<const segment> lines, float pixels_wide);
  std::uint32_t calls() const { return calls_; }  // of OpenGL's draw functions since begin, without lines

  unsigned framebuffer() const;
  sightcell::picture::image_rgba read() const;
  void show_in_window() const;  // copies the frame to the window's own buffer, of the same size

 private:
  struct state;
  std::unique_ptr<state> state_;
  std::uint32_t calls_ = 0;
};

// Throws sightcell::error when OpenGL has reported an error since the last check.
void check_gl(const char* where);

}  // namespace viewer
