#include "window.h"

#include <epoxy/gl.h>
// After epoxy, which brings its own OpenGL header.
#include <GLFW/glfw3.h>

#include <algorithm>

#include "sightcell/base/error.h"

namespace viewer {
namespace {

constexpr double rest_counts = 0.03;  // seconds: a key that ends a rest does not move the camera for all of it

using sightcell::error;
using sightcell::error_kind;

// The pure half knows these numbers without GLFW's header.
static_assert(GLFW_KEY_A == 'A' && GLFW_KEY_1 == '1' && GLFW_KEY_ESCAPE == 256 && GLFW_KEY_LEFT_SHIFT == 340 &&
              GLFW_KEY_RIGHT_SHIFT == 344 && GLFW_KEY_SPACE == 32);

std::string last_glfw_error() {
  const char* text = nullptr;
  if (glfwGetError(&text) == GLFW_NO_ERROR || text == nullptr) return "no reason given";
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

}  // namespace

window::window(const std::string& title, std::uint32_t width, std::uint32_t height, bool visible) {
  if (glfwInit() != GLFW_TRUE) {
    throw error(error_kind::failed, "viewer.no-display", "display", "cannot be opened: " + last_glfw_error(),
                "set DISPLAY to a running X server, or start one with xvfb-run");
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);  // the scene is drawn into a frame of our own
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
  handle_ = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(), nullptr, nullptr);
  if (handle_ == nullptr) {
    const std::string cause = last_glfw_error();
    glfwTerminate();
    throw error(error_kind::failed, "viewer.no-context", "window", "no OpenGL 4.5 core: " + cause,
                "install a driver with OpenGL 4.5, for example Mesa's (libgl1-mesa-dri)");
  }
  glfwMakeContextCurrent(handle_);
  glfwSwapInterval(visible ? 1 : 0);
  glfwSetWindowUserPointer(handle_, this);
  glfwSetKeyCallback(handle_, on_key);
  glfwSetScrollCallback(handle_, on_scroll);
  glfwSetWindowFocusCallback(handle_, on_focus);
  glfwSetMouseButtonCallback(handle_, on_button);
  last_poll_ = glfwGetTime();
}

window::~window() {
  glfwDestroyWindow(handle_);
  glfwTerminate();
}

bool window::closing() const {
  return glfwWindowShouldClose(handle_) == GLFW_TRUE;
}

input window::poll(double idle) {
  const bool hidden = width() == 0 || height() == 0 || glfwGetWindowAttrib(handle_, GLFW_ICONIFIED) == GLFW_TRUE;
  if (hidden) {
    glfwWaitEventsTimeout(0.5);
  } else if (idle > 0.0) {
    glfwWaitEventsTimeout(idle);
    last_poll_ = std::max(last_poll_, glfwGetTime() - rest_counts);
  } else {
    glfwPollEvents();
  }
  if (looking_) {
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(handle_, &x, &y);
    events_.look = {static_cast<float>(x - mouse_x_), static_cast<float>(y - mouse_y_)};
    mouse_x_ = x;
    mouse_y_ = y;
  }
  const double now = glfwGetTime();
  events_.seconds = static_cast<float>(now - last_poll_);
  last_poll_ = now;
  input result = events_;
  result.mouse = looking_ ? glm::vec2(-1.0f) : mouse();
  result.mouse_down = events_.mouse_down || down_;  // a click may begin and end between two frames
  const action_set still_held = events_.held;
  events_ = {};
  events_.held = still_held;
  return result;
}

std::uint32_t window::width() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(handle_, &width, &height);
  return static_cast<std::uint32_t>(std::max(width, 0));
}

std::uint32_t window::height() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(handle_, &width, &height);
  return static_cast<std::uint32_t>(std::max(height, 0));
}

float window::scale() const {
  float x = 1.0f, y = 1.0f;
  glfwGetWindowContentScale(handle_, &x, &y);
  return std::clamp(x, 1.0f, 4.0f);
}

void window::present() {
  glfwSwapBuffers(handle_);
}

window& window::of(GLFWwindow* handle) {
  return *static_cast<window*>(glfwGetWindowUserPointer(handle));
}

void window::on_key(GLFWwindow* handle, int key, int, int what, int) {
  const auto found = action_of_key(key);
  if (!found) return;
  input& events = of(handle).events_;
  events.held.set(static_cast<std::size_t>(*found), what != GLFW_RELEASE);
  if (what == GLFW_PRESS) events.pressed.set(static_cast<std::size_t>(*found));
}

void window::on_scroll(GLFWwindow* handle, double, double up) {
  of(handle).events_.wheel += static_cast<float>(up);
}

void window::on_focus(GLFWwindow* handle, int focused) {
  if (focused == GLFW_TRUE) return;
  of(handle).events_.held.reset();  // a key released elsewhere would be held for ever
  of(handle).down_ = false;
  of(handle).set_looking(false);
}

void window::on_button(GLFWwindow* handle, int button, int what, int) {
  window& w = of(handle);
  const bool pressed = what == GLFW_PRESS;
  if (button == GLFW_MOUSE_BUTTON_LEFT) {
    w.down_ = pressed;
    if (pressed) w.events_.mouse_down = true;
  }
  const bool for_panel = pressed && !w.looking_ && w.taken_ && w.taken_(w.mouse());
  if (!for_panel) w.set_looking(pressed || w.mouse_look_);
}

void window::set_mouse_look(bool on) {
  if (on == mouse_look_) return;
  mouse_look_ = on;
  set_looking(on);
}

glm::vec2 window::mouse() const {
  double x = 0.0, y = 0.0;
  int across = 1, along = 1;
  glfwGetCursorPos(handle_, &x, &y);
  glfwGetWindowSize(handle_, &across, &along);
  return {static_cast<float>(x) * static_cast<float>(width()) / static_cast<float>(std::max(across, 1)),
          static_cast<float>(y) * static_cast<float>(height()) / static_cast<float>(std::max(along, 1))};
}

void window::set_looking(bool looking) {
  if (looking == looking_) return;
  looking_ = looking;
  glfwSetInputMode(handle_, GLFW_CURSOR, looking ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
  glfwGetCursorPos(handle_, &mouse_x_, &mouse_y_);
}

}  // namespace viewer
