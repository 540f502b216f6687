#pragma once
// The text over the picture.
#include <string>

#include "baked_scene.h"
#include "controls.h"
#include "visible_lists.h"

namespace viewer {

// What the text says beside the state of camera and lists.
struct frame_facts {
  std::uint64_t polygons_drawn = 0;
  double frames_per_second = 0.0;
  double gpu_milliseconds = 0.0;
  std::string renderer;  // GL_RENDERER
};

class hud {
 public:
  explicit hud(float scale);
  ~hud();
  hud(const hud&) = delete;
  hud& operator=(const hud&) = delete;

  // Draws into the framebuffer that is bound.
  void draw(const baked_scene& baked, const controls& state, const visible_lists& lists, const frame_facts& facts,
            std::uint32_t width, std::uint32_t height);

 private:
  bool measured_ = false;
};

// 1234567 as "1,234,567".
std::string with_commas(std::uint64_t number);

}  // namespace viewer
