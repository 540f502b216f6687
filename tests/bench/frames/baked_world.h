#pragma once
// A scene as a host has it that flattened it into world space, and the file with the layout for that (merged). No
// OpenGL.
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"

namespace sightcell::bench {

// What is drawn with one state: the polygons of a draw group of the file, first to first + count - 1 in stored order.
struct surface_group {
  const scene::material* material = nullptr;
  std::uint32_t first = 0, count = 0;
};

struct baked_world {
  // Throws sightcell::error, and std::runtime_error where the two files do not belong together.
  baked_world(const std::filesystem::path& scene_file, const std::filesystem::path& pvs_file);
  baked_world(const baked_world&) = delete;  // its groups know its materials
  baked_world& operator=(const baked_world&) = delete;

  scene::scene s;
  scene::world_geometry geometry;
  sightcell::db db;
  sightcell_info info{};
  std::vector<std::uint32_t> source_of_stored;
  std::vector<std::uint32_t> stored_corners;  // three vertices per stored polygon
  std::vector<surface_group> groups;          // by the number that ranges and commands have
  // What hides first, what is cut out by alpha after it, what is blended last.
  std::vector<std::uint32_t> draw_order;

  std::uint32_t polygons() const { return info.polygon_count; }
};

}  // namespace sightcell::bench
