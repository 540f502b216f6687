#pragma once
// Without a window: the same frames in each mode, what they take, and what they show.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "camera.h"
#include "renderer.h"
#include "sightcell/sightcell.hpp"

namespace vulkan_host {

inline constexpr std::array<const char*, 4> mode_names = {"everything", "frustum", "commands", "clusters"};

struct result {
  draw_mode mode = draw_mode::everything;
  effort sums;
  double cpu_milliseconds = 0.0;  // of the process; a driver for the CPU draws in it
  std::uint64_t wrong = 0, ties = 0, pixels = 0;

  double wrong_share() const { return pixels == 0 ? 0.0 : static_cast<double>(wrong) / static_cast<double>(pixels); }
};

// Views from a valid viewpoint of each of `cells` cells that are spread over the file, in `headings` directions each.
// Throws vulkan.no-viewpoint if the file has none: the middle of a cell may be in a wall, where no set holds.
std::vector<camera> find_views(const sightcell::db& db, const std::string& file, std::uint32_t cells,
                               std::uint32_t headings, float aspect);

// Draws all views in each mode, two frames in flight; then again one by one, and compares the pictures with those of
// everything.
std::vector<result> measure(const device& on, renderer& draws, const std::vector<camera>& views);

}  // namespace vulkan_host
