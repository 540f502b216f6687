#pragma once
// What keys and mouse do: input -> state, without a window, so that tests can press every key.
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

namespace viewer {

enum class action : std::uint8_t {
  // While held.
  forward,
  back,
  left,
  right,
  up,
  down,
  faster,
  jump,
  // When pressed.
  pvs,
  objects,
  frustum,
  freeze,
  tint,
  count_wrong,
  walk,
  mouse_look,
  map,
  box,
  all_cells,
  next_cell,
  previous_cell,
  wireframe,
  hud,
  screenshot,
  print,
  quit,
  count
};
using action_set = std::bitset<static_cast<std::size_t>(action::count)>;

// One key. Key numbers are GLFW's: ASCII for letters and digits.
struct key_binding {
  int key;
  action what;
  const char* name;
  const char* help;
};
std::span<const key_binding> key_bindings();
std::optional<action> action_of_key(int key);

// Angles in radians. Yaw 0 looks along -Z and grows to the right; pitch grows upwards.
struct fly_camera {
  glm::vec3 eye{0.0f};
  float yaw = 0.0f, pitch = 0.0f;
  float vertical_fov = 1.2f;
  glm::vec3 forward() const;
  glm::vec3 right() const;
};

// What happened since the last frame.
struct input {
  action_set held, pressed;
  glm::vec2 look{0.0f};  // pixels the mouse was dragged, right and down
  float wheel = 0.0f;    // notches, forward is positive
  float seconds = 0.0f;
  glm::vec2 mouse{-1.0f};   // pixels from the upper left corner
  bool mouse_down = false;  // the left button, at some time since the last frame
};

struct controls {
  fly_camera camera;
  float speed = 4.0f;       // meters per second
  float brightness = 1.0f;  // what light is multiplied with
  bool pvs = true, objects = false, frustum = false, frozen = false, tint = false, count_wrong = false;
  bool box = true, all_cells = false, wireframe = false, hud = true, map = true;
  bool walking = false, mouse_look = false;  // mouse_look: it turns the camera without being dragged
  // Asked for by the last step.
  int cell_steps = 0;
  bool screenshot = false, print = false, quit = false;
  // Asked for in the panel, for the next step to clear.
  const char* bake_quality = nullptr;  // of a bake to start
  bool stop_bake = false, open_file = false;
  glm::vec3 velocity{0.0f};  // of a person who walks, meters per second
  bool jump = false;
  float seconds = 0.0f;  // that the step is about
};

// Turns and, unless it walks, moves the camera. Walking needs the scene: see walker.
void step(controls& state, const input& in);

}  // namespace viewer
