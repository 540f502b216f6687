#pragma once
// The program: opens scene and file, then flies, or draws one picture or a path and ends.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace viewer {

enum class draw_mode { pvs, all, tint };

struct options {
  std::string scene_file, pvs_file, cells_file;
  int scene = -1;  // of the glTF file; -1: its default
  std::uint32_t width = 1280, height = 800;
  std::optional<std::array<float, 3>> eye;
  std::optional<std::array<float, 2>> look;  // yaw, pitch in degrees
  std::optional<float> fov;                  // vertical, degrees
  std::optional<float> brightness;
  std::optional<std::uint32_t> cell, frozen_from;
  draw_mode mode = draw_mode::pvs;
  bool objects = false, frustum = false, walk = false;
  std::string screenshot;  // a .png: draw it without a visible window, print what was drawn, end
  std::uint32_t frames = 1;
  bool hud = false, map = false, box = false, all_cells = false, wireframe = false;  // of a screenshot
  bool wrong = false;
  std::string record, replay, benchmark;  // files
  std::string camera_file;                // receives the place of the camera, for a bake --watch --near
  std::string bake;                       // quality of a bake that begins at once, where there is no .pvs file
  std::uint32_t poses = 0;                // of a benchmark; 0: all of the path
};

// Throws sightcell::error.
void run(const options& chosen);

}  // namespace viewer
