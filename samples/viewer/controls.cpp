#include "controls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace viewer {
namespace {

constexpr float radians_per_pixel = 0.004f;
constexpr float steepest = 0.49f * std::numbers::pi_v<float>;  // straight up has no right-hand side
constexpr float slowest = 0.1f, fastest = 1000.0f;             // meters per second
constexpr float per_notch = 1.25f;
constexpr float when_faster = 5.0f;
constexpr float fastest_walk = 12.0f;  // meters per second, before Shift
constexpr float longest_step = 0.1f;   // seconds: a frame that hung must not throw the camera through a wall

constexpr std::array bindings{
    key_binding{'W', action::forward, "W", "forward"},
    key_binding{'S', action::back, "S", "back"},
    key_binding{'A', action::left, "A", "left"},
    key_binding{'D', action::right, "D", "right"},
    key_binding{'E', action::up, "E", "up"},
    key_binding{'Q', action::down, "Q", "down"},
    key_binding{340, action::faster, "Shift", "5x faster"},
    key_binding{344, action::faster, "Right Shift", "5x faster"},
    key_binding{32, action::jump, "Space", "jump"},
    key_binding{'G', action::walk, "G", "walk, fly"},
    key_binding{'L', action::mouse_look, "L", "mouse look"},
    key_binding{'P', action::pvs, "P", "PVS on, off"},
    key_binding{'R', action::objects, "R", "whole objects"},
    key_binding{'U', action::frustum, "U", "frustum culling"},
    key_binding{'F', action::freeze, "F", "freeze"},
    key_binding{'V', action::tint, "V", "what the set lacks in red"},
    key_binding{'K', action::count_wrong, "K", "count wrong pixels"},
    key_binding{'M', action::map, "M", "map"},
    key_binding{'O', action::box, "O", "box of the cell"},
    key_binding{'C', action::all_cells, "C", "all cells"},
    key_binding{'N', action::next_cell, "N", "next cell"},
    key_binding{'B', action::previous_cell, "B", "previous cell"},
    key_binding{'X', action::wireframe, "X", "wireframe"},
    key_binding{'H', action::hud, "H", "panel"},
    key_binding{'1', action::screenshot, "1", "screenshot"},
    key_binding{'2', action::print, "2", "print numbers"},
    key_binding{256, action::quit, "Esc", "release the mouse, quit"},
};

bool has(const action_set& set, action what) {
  return set.test(static_cast<std::size_t>(what));
}

void toggle(bool& value, const action_set& pressed, action what) {
  if (has(pressed, what)) value = !value;
}

void turn(fly_camera& camera, const glm::vec2& look) {
  camera.yaw = std::remainder(camera.yaw + radians_per_pixel * look.x, 2.0f * std::numbers::pi_v<float>);
  camera.pitch = std::clamp(camera.pitch - radians_per_pixel * look.y, -steepest, steepest);
}

glm::vec3 direction_of(const fly_camera& camera, const action_set& held) {
  const auto axis = [&](action plus, action minus) {
    return static_cast<float>(has(held, plus)) - static_cast<float>(has(held, minus));
  };
  const glm::vec3 sum = axis(action::forward, action::back) * camera.forward() +
                        axis(action::right, action::left) * camera.right() +
                        axis(action::up, action::down) * glm::vec3(0.0f, 1.0f, 0.0f);
  const float length = glm::length(sum);
  return length > 1e-4f ? sum / length : glm::vec3(0.0f);
}

}  // namespace

std::span<const key_binding> key_bindings() {
  return bindings;
}

std::optional<action> action_of_key(int key) {
  const auto found = std::find_if(bindings.begin(), bindings.end(), [&](const key_binding& b) { return b.key == key; });
  if (found == bindings.end()) return std::nullopt;
  return found->what;
}

glm::vec3 fly_camera::forward() const {
  return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)};
}

glm::vec3 fly_camera::right() const {
  return {std::cos(yaw), 0.0f, std::sin(yaw)};
}

namespace {

void switch_over(controls& state, const action_set& pressed) {
  toggle(state.pvs, pressed, action::pvs);
  toggle(state.objects, pressed, action::objects);
  toggle(state.frustum, pressed, action::frustum);
  toggle(state.frozen, pressed, action::freeze);
  toggle(state.tint, pressed, action::tint);
  toggle(state.count_wrong, pressed, action::count_wrong);
  toggle(state.map, pressed, action::map);
  toggle(state.box, pressed, action::box);
  toggle(state.all_cells, pressed, action::all_cells);
  toggle(state.wireframe, pressed, action::wireframe);
  toggle(state.hud, pressed, action::hud);
  toggle(state.walking, pressed, action::walk);
  toggle(state.mouse_look, pressed, action::mouse_look);
}

}  // namespace

void step(controls& state, const input& in) {
  state.bake_quality = nullptr;
  state.stop_bake = state.open_file = false;
  turn(state.camera, in.look);
  state.speed = std::clamp(state.speed * std::pow(per_notch, in.wheel), slowest, fastest);
  state.seconds = std::clamp(in.seconds, 0.0f, longest_step);
  const float faster = has(in.held, action::faster) ? when_faster : 1.0f;
  if (state.walking) {
    fly_camera level = state.camera;  // looking down is no reason to walk slower
    level.pitch = 0.0f;
    action_set held = in.held;
    held.reset(static_cast<std::size_t>(action::up));
    held.reset(static_cast<std::size_t>(action::down));
    state.velocity = std::min(state.speed, fastest_walk) * faster * direction_of(level, held);
  } else {
    state.camera.eye += state.speed * faster * state.seconds * direction_of(state.camera, in.held);
  }
  state.jump = has(in.held, action::jump) || has(in.pressed, action::jump);
  switch_over(state, in.pressed);
  state.cell_steps =
      static_cast<int>(has(in.pressed, action::next_cell)) - static_cast<int>(has(in.pressed, action::previous_cell));
  state.screenshot = has(in.pressed, action::screenshot);
  state.print = has(in.pressed, action::print);
  const bool escape = has(in.pressed, action::quit);
  state.quit = escape && !state.mouse_look;
  if (escape) state.mouse_look = false;
}

}  // namespace viewer
