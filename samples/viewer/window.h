#pragma once
// A window with OpenGL 4.5 core, and what was pressed in it.
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <string>

#include "controls.h"

struct GLFWwindow;

namespace viewer {

class window {
 public:
  // The context is current afterwards. Throws sightcell::error when there is no display or no OpenGL 4.5.
  window(const std::string& title, std::uint32_t width, std::uint32_t height, bool visible);
  ~window();
  window(const window&) = delete;
  window& operator=(const window&) = delete;

  bool closing() const;
  // Handles what has happened since the last call; waits for something while nothing of the window can be seen.
  // idle: nothing moves. It then waits this many seconds for something to happen; 0: it does not wait.
  input poll(double idle);
  // In pixels; 0 while minimised.
  std::uint32_t width() const, height() const;
  // Turns the camera without a button. Hides the mouse while it does.
  void set_mouse_look(bool on);
  // Where a press of the mouse is not for the camera.
  void set_taken(std::function<bool(const glm::vec2& pixel)> taken) { taken_ = std::move(taken); }
  float scale() const;  // of text, larger than 1 on dense displays
  void present();       // waits for the display's next refresh

 private:
  static window& of(GLFWwindow* handle);
  static void on_key(GLFWwindow* handle, int key, int scancode, int what, int modifiers);
  static void on_scroll(GLFWwindow* handle, double right, double up);
  static void on_focus(GLFWwindow* handle, int focused);
  static void on_button(GLFWwindow* handle, int button, int what, int modifiers);
  void set_looking(bool looking);
  glm::vec2 mouse() const;  // pixels

  GLFWwindow* handle_ = nullptr;
  input events_;
  bool looking_ = false;     // the mouse turns the camera
  bool mouse_look_ = false;  // without a button
  bool down_ = false;        // the left button
  std::function<bool(const glm::vec2&)> taken_;
  double mouse_x_ = 0.0, mouse_y_ = 0.0, last_poll_ = 0.0;
};

}  // namespace viewer
