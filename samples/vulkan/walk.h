#pragma once
// With a window: a walk with keys and mouse.
#include <cstdint>
#include <string>

#include "host_scene.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"
#include "visibility.h"

namespace vulkan_host {

struct walk_options {
  std::uint32_t width = 960, height = 540;
  std::uint32_t frames = 0;  // after which the walk ends; 0: when the window is closed
  bool validates = false, may_count = true;
  std::string screenshot;  // of the last frame; empty: none
};

// Opens a window at the first valid viewpoint of the file. Returns the number of messages of the validation layer.
// Throws vulkan.window, vulkan.*.
std::uint32_t walk(const sightcell::scene::scene& s, const sightcell::db& db, const std::string& pvs_file,
                   const host_scene& host, visibility& visible, const walk_options& options);

}  // namespace vulkan_host
