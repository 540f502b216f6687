#pragma once
// The scene that samplers are compared on, and its cells.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/samplers/jobs.h"
#include "cells/view_cell.h"
#include "hemicube/surface_colors.h"
#include "sightcell/base/box.h"
#include "sightcell/scene/scene.h"
#include "trace/duplicates.h"
#include "trace/ray_scene.h"

namespace sightcell::bench {

struct ground {
  // Works on the calling thread's TBB arena. Cells without a free point are left out. hash: names the scene's content.
  ground(scene::scene from, std::vector<bake::view_cell> all, const seeing_rules& rules, std::string hash);
  ground(const ground&) = delete;  // its parts know each other
  ground& operator=(const ground&) = delete;

  const scene::scene s;
  const scene::world_geometry geometry;
  const seeing_rules rules;
  const std::string hash;
  bake::ray_scene rays;
  const bake::duplicate_classes duplicates;
  bake::surface_colors colors;
  std::vector<bake::view_cell> cells;
  std::vector<std::string> names;     // of each cell
  std::vector<bool> geometry_inside;  // of each cell
  std::vector<std::string> left_out;

  std::uint32_t polygons() const { return static_cast<std::uint32_t>(geometry.kinds.size()); }
  bake::box grown(std::size_t cell) const { return bake::box{cells[cell].min, cells[cell].max}.grown(rules.margin); }
  // By name. Throws sightcell::error where there is none, or it was left out.
  std::size_t cell_named(const std::string& name) const;
  // Names a cell of this scene under these rules.
  std::string text_of(std::size_t cell) const;
};

// From files. cells: empty for automatic ones, of which limit are taken, evenly spread (0: all). hash: empty for that
// of the file. Throws sightcell::error.
std::unique_ptr<ground> load_ground(const std::filesystem::path& scene, const std::filesystem::path& cells,
                                    std::uint32_t limit, const seeing_rules& rules, std::string hash);

}  // namespace sightcell::bench
