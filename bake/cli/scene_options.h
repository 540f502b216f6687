#pragma once
// The scene of bake and verify; or two scenes: one has the cells, the other the polygons of the sets.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "progress_line.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

struct scene_options {
  std::filesystem::path scene;  // SCENE, or --polygons-from
  std::filesystem::path polygons_from, cells_from;

  bool two() const { return !cells_from.empty(); }
};

// Adds SCENE.
// options: must outlive the verb.
void add_scene_argument(CLI::App& verb, scene_options& options, const std::string& help);

// Adds the two options for a second scene.
void add_two_scene_options(CLI::App& verb, scene_options& options, const std::string& group);

// Checks that one way or the other was used, and makes options.scene the scene that sets are about. To be called by the
// callback of the verb.
// file: the second positional argument of the verb, or null. Without SCENE it is the first one.
// Fails with CLI::ParseError.
void settle_scenes(scene_options& options, std::filesystem::path* file = nullptr);

// Loads the scene of the cells if it is another one. Prints its warnings and counts.
std::optional<scene::scene> load_scene_of_cells(const scene_options& options, progress_line& line);

}  // namespace sightcell::cli
