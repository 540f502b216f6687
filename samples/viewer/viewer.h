#pragma once
// The program: opens scene and file, then flies, or draws one picture and ends.
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
  std::optional<std::uint32_t> cell, frozen_from;
  draw_mode mode = draw_mode::pvs;
  std::string screenshot;  // a .png: draw it without a visible window, say what was drawn, end
  std::uint32_t frames = 1;
  bool hud = false, box = false, all_cells = false, wireframe = false;  // of a screenshot
};

// Throws sightcell::error.
void run(const options& chosen);

}  // namespace viewer
