#pragma once
// Draws lists of an engine_scene into an offscreen frame and reads it back.
#include <cstdint>
#include <glm/vec3.hpp>

#include "difference.h"
#include "engine_scene.h"
#include "sightcell/picture/gl_program.h"
#include "visible_set.h"

namespace engine_hook {

// What one picture took.
struct effort {
  std::uint64_t polygons = 0;
  std::uint64_t calls = 0;  // of OpenGL
};

struct camera {
  glm::vec3 eye, right, up, forward;  // a square picture, 90 degrees wide
};

class renderer {
 public:
  explicit renderer(std::uint32_t size);  // pixels along a side
  ~renderer();
  renderer(const renderer&) = delete;
  renderer& operator=(const renderer&) = delete;

  effort draw(const engine_scene& engine, const camera& view, const draw_list& list);
  effort draw(const engine_scene& engine, const camera& view, const command_list& list);
  // The backs of solid polygons too, with surface 0xFFFFFFFF: an eye that sees many is inside something.
  void draw_with_backs(const engine_scene& engine, const camera& view, const draw_list& list);

  picture read() const;

 private:
  void begin(const engine_scene& engine, const camera& view);
  void begin_pass(bool blended) const;
  void bind(const batch& b) const;

  sightcell::picture::gl_program program_;
  GLsizei size_;
  GLuint images_[3] = {}, framebuffer_ = 0, array_ = 0;
};

}  // namespace engine_hook
