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
constexpr float longest_step = 0.1f;  // seconds: a frame that hung must not throw the camera through a wall

constexpr std::array bindings{
    key_binding{'W', action::forward, "W", "forward"},
    key_binding{'S', action::back, "S", "back"},
    key_binding{'A', action::left, "A", "left"},
    key_binding{'D', action::right, "D", "right"},
    key_binding{'E', action::up, "E", "up"},
    key_binding{'Q', action::down, "Q", "down"},
    key_binding{340, action::faster, "Shift", "5x faster"},
    key_binding{344, action::faster, "Right Shift", "5x faster"},
    key_binding{'P', action::pvs, "P", "PVS on, off"},
    key_binding{'F', action::freeze, "F", "freeze this cell's set"},
    key_binding{'V', action::tint, "V", "paint red what the set lacks"},
    key_binding{'O', action::box, "O", "cell box"},
    key_binding{'C', action::all_cells, "C", "all cells"},
    key_binding{'N', action::next_cell, "N", "next cell"},
    key_binding{'B', action::previous_cell, "B", "previous cell"},
    key_binding{'X', action::wireframe, "X", "wireframe"},
    key_binding{'H', action::hud, "H", "this text"},
    key_binding{'1', action::screenshot, "1", "screenshot"},
    key_binding{256, action::quit, "Esc", "quit"},
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

void step(controls& state, const input& in) {
  turn(state.camera, in.look);
  state.speed = std::clamp(state.speed * std::pow(per_notch, in.wheel), slowest, fastest);
  const float seconds = std::clamp(in.seconds, 0.0f, longest_step);
  const float speed = state.speed * (has(in.held, action::faster) ? when_faster : 1.0f);
  state.camera.eye += speed * seconds * direction_of(state.camera, in.held);

  toggle(state.pvs, in.pressed, action::pvs);
  toggle(state.frozen, in.pressed, action::freeze);
  toggle(state.tint, in.pressed, action::tint);
  toggle(state.box, in.pressed, action::box);
  toggle(state.all_cells, in.pressed, action::all_cells);
  toggle(state.wireframe, in.pressed, action::wireframe);
  toggle(state.hud, in.pressed, action::hud);
  state.cell_steps =
      static_cast<int>(has(in.pressed, action::next_cell)) - static_cast<int>(has(in.pressed, action::previous_cell));
  state.screenshot = has(in.pressed, action::screenshot);
  state.quit = has(in.pressed, action::quit);
}

}  // namespace viewer
