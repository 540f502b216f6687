#pragma once
// The panel over the picture: switches, numbers and graphs, with Dear ImGui.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>

#include "background_bake.h"
#include "baked_scene.h"
#include "cell_map.h"
#include "controls.h"
#include "visible_lists.h"

namespace viewer {

// What the panel shows beside the state of camera and lists.
struct frame_facts {
  std::uint64_t polygons_drawn = 0;
  std::size_t ranges_drawn = 0;
  std::uint32_t calls = 0;
  double frames_per_second = 0.0, frame_milliseconds = 0.0, gpu_milliseconds = 0.0;
  std::uint64_t cell_changes = 0;
  std::optional<std::uint64_t> wrong_pixels;  // of the last count
  std::uint64_t pixels = 0;
  std::string renderer;                   // GL_RENDERER
  std::string message;                    // of a file that could not be read again, of a path that is replayed
  const background_bake* bake = nullptr;  // where the viewer began without a .pvs file
  bool file_beside = false;               // the file that this bake would write exists
};

// The last frames, for the graphs.
class frame_history {
 public:
  static constexpr std::size_t length = 180;
  void add(const frame_facts& facts, bool cell_changed);

  std::array<float, length> milliseconds{}, polygons{}, calls{};
  std::array<bool, length> changed{};
  std::size_t next = 0;  // the oldest
};

class panel {
 public:
  explicit panel(float scale);
  ~panel();
  panel(const panel&) = delete;
  panel& operator=(const panel&) = delete;

  // Takes what the mouse did in the window. Before draw.
  void take_input(const input& in);
  // It covers nothing until the next draw.
  void hide() { rectangles_ = {}; }
  // Whether a press at this pixel is for the panel.
  bool covers(const glm::vec2& pixel) const;
  // Draws into the framebuffer that is bound; changes the state if a switch is clicked. map: null without cells.
  // wait: until the map is complete, for pictures.
  // Returns the cell of the map that was clicked.
  std::optional<std::uint32_t> draw(const baked_scene& baked, controls& state, const visible_lists& lists,
                                    const frame_facts& facts, const frame_history& history, cell_map* map,
                                    std::uint32_t width, std::uint32_t height, bool wait);

 private:
  bool measured_ = false;
  float scale_ = 1.0f;
  std::array<glm::vec4, 2> rectangles_{};  // left, top, right, bottom: panel and map
};

}  // namespace viewer
