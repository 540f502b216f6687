#include "controls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>
#include <string>

namespace viewer {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

input holding(std::initializer_list<action> actions, float seconds) {
  input in;
  for (const action a : actions) in.held.set(static_cast<std::size_t>(a));
  in.seconds = seconds;
  return in;
}

input pressing(action what) {
  input in;
  in.pressed.set(static_cast<std::size_t>(what));
  return in;
}

void expect_near(const glm::vec3& a, const glm::vec3& b) {
  EXPECT_LT(glm::distance(a, b), 1e-4f) << a.x << ' ' << a.y << ' ' << a.z;
}

// Where one held key leads within a tenth of a second at 4 m/s, the first speed.
glm::vec3 way_of(int key, float yaw = 0.0f, float pitch = 0.0f) {
  controls state;
  state.camera.yaw = yaw;
  state.camera.pitch = pitch;
  step(state, holding({action_of_key(key).value()}, 0.1f));
  return state.camera.eye;
}

TEST(controls, keys_move_along_the_camera) {
  expect_near(way_of('W'), {0, 0, -0.4f});
  expect_near(way_of('S'), {0, 0, 0.4f});
  expect_near(way_of('A'), {-0.4f, 0, 0});
  expect_near(way_of('D'), {0.4f, 0, 0});
  expect_near(way_of('E'), {0, 0.4f, 0});
  expect_near(way_of('Q'), {0, -0.4f, 0});
  // Yaw 90 degrees looks along +X, its right-hand side is +Z.
  expect_near(way_of('W', pi / 2), {0.4f, 0, 0});
  expect_near(way_of('D', pi / 2), {0, 0, 0.4f});
  // Up is up however the camera is tilted; forward goes where it looks.
  expect_near(way_of('E', 0.0f, pi / 4), {0, 0.4f, 0});
  expect_near(way_of('W', 0.0f, pi / 4), {0, 0.4f * std::sqrt(0.5f), -0.4f * std::sqrt(0.5f)});
}

TEST(controls, two_keys_are_no_faster_than_one_and_opposite_keys_stand_still) {
  controls state;
  step(state, holding({action::forward, action::right}, 0.1f));
  EXPECT_NEAR(glm::length(state.camera.eye), 0.4f, 1e-5f);
  state.camera.eye = {};
  step(state, holding({action::forward, action::back}, 0.1f));
  expect_near(state.camera.eye, {});
}

TEST(controls, shift_is_five_times_faster_and_alone_does_nothing) {
  controls state;
  step(state, holding({action::forward, action::faster}, 0.1f));
  expect_near(state.camera.eye, {0, 0, -2.0f});
  step(state, holding({action::faster}, 0.1f));
  expect_near(state.camera.eye, {0, 0, -2.0f});
  EXPECT_EQ(action_of_key(340), action::faster);
  EXPECT_EQ(action_of_key(344), action::faster);
}

TEST(controls, a_frame_that_hung_does_not_throw_the_camera_far) {
  controls state;
  step(state, holding({action::forward}, 60.0f));
  expect_near(state.camera.eye, {0, 0, -0.4f});
  step(state, holding({action::forward}, -1.0f));
  expect_near(state.camera.eye, {0, 0, -0.4f});
}

TEST(controls, the_mouse_turns_right_and_up_and_stops_before_the_zenith) {
  controls state;
  input in;
  in.look = {100.0f, -50.0f};
  step(state, in);
  EXPECT_GT(state.camera.yaw, 0.1f);
  EXPECT_GT(state.camera.pitch, 0.1f);
  EXPECT_GT(state.camera.forward().x, 0.0f);
  EXPECT_GT(state.camera.forward().y, 0.0f);
  in.look = {0.0f, -1e6f};
  step(state, in);
  EXPECT_LT(state.camera.pitch, pi / 2);
  EXPECT_GT(state.camera.pitch, 0.9f * pi / 2);
  in.look = {1e5f, 1e6f};
  step(state, in);
  EXPECT_GT(state.camera.pitch, -pi / 2);
  EXPECT_LE(std::abs(state.camera.yaw), pi + 1e-5f);
  EXPECT_NEAR(glm::dot(state.camera.forward(), state.camera.right()), 0.0f, 1e-5f);
}

TEST(controls, the_wheel_changes_speed_within_bounds) {
  controls state;
  input in;
  in.wheel = 1.0f;
  step(state, in);
  EXPECT_GT(state.speed, 4.0f);
  in.wheel = -1.0f;
  step(state, in);
  EXPECT_NEAR(state.speed, 4.0f, 1e-4f);
  in.wheel = 1e3f;
  step(state, in);
  EXPECT_EQ(state.speed, 1000.0f);
  in.wheel = -1e3f;
  step(state, in);
  EXPECT_EQ(state.speed, 0.1f);
}

TEST(controls, switches_turn_over_once_per_press) {
  controls state;
  const auto press = [&](int key) { step(state, pressing(action_of_key(key).value())); };
  const auto expect_switch = [&](int key, const bool& value) {
    const bool before = value;
    press(key);
    EXPECT_NE(value, before) << static_cast<char>(key);
    step(state, {});
    EXPECT_NE(value, before) << static_cast<char>(key);
    press(key);
    EXPECT_EQ(value, before) << static_cast<char>(key);
  };
  EXPECT_TRUE(state.pvs);
  EXPECT_FALSE(state.frozen);
  expect_switch('P', state.pvs);
  expect_switch('F', state.frozen);
  expect_switch('V', state.tint);
  expect_switch('O', state.box);
  expect_switch('C', state.all_cells);
  expect_switch('X', state.wireframe);
  expect_switch('H', state.hud);
  expect_switch('R', state.objects);
  expect_switch('U', state.frustum);
  expect_switch('K', state.count_wrong);
  expect_switch('M', state.map);
  expect_switch('G', state.walking);
  expect_switch('L', state.mouse_look);
}

TEST(controls, requests_last_one_frame) {
  controls state;
  step(state, pressing(action_of_key('N').value()));
  EXPECT_EQ(state.cell_steps, 1);
  step(state, pressing(action_of_key('B').value()));
  EXPECT_EQ(state.cell_steps, -1);
  step(state, pressing(action_of_key('1').value()));
  EXPECT_EQ(state.cell_steps, 0);
  EXPECT_TRUE(state.screenshot);
  step(state, pressing(action_of_key(256).value()));
  EXPECT_FALSE(state.screenshot);
  EXPECT_TRUE(state.quit);
  step(state, {});
  EXPECT_FALSE(state.quit);
  step(state, pressing(action_of_key('2').value()));
  EXPECT_TRUE(state.print);
}

TEST(controls, escape_releases_the_mouse_before_it_ends) {
  controls state;
  state.mouse_look = true;
  step(state, pressing(action::quit));
  EXPECT_FALSE(state.quit);
  EXPECT_FALSE(state.mouse_look);
  step(state, pressing(action::quit));
  EXPECT_TRUE(state.quit);
}

TEST(controls, on_foot_keys_ask_for_a_level_velocity) {
  controls state;
  state.walking = true;
  state.camera.pitch = -1.0f;
  step(state, holding({action::forward, action::up}, 0.1f));
  expect_near(state.camera.eye, {});
  expect_near(state.velocity, {0, 0, -4.0f});
  step(state, pressing(action::jump));
  EXPECT_TRUE(state.jump);
}

TEST(controls, every_action_has_a_key_and_no_key_has_two) {
  std::set<int> keys;
  action_set bound;
  for (const key_binding& b : key_bindings()) {
    EXPECT_TRUE(keys.insert(b.key).second) << b.name;
    EXPECT_FALSE(std::string(b.help).empty());
    bound.set(static_cast<std::size_t>(b.what));
  }
  EXPECT_TRUE(bound.all()) << bound;
  EXPECT_FALSE(action_of_key('Z').has_value());
  EXPECT_FALSE(action_of_key(-1).has_value());
}

}  // namespace
}  // namespace viewer
