#pragma once
// The scene of bake and verify, or the two of what the cells of one see of another.
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

// Adds SCENE and the two options. They must outlive the verb.
void add_scene_options(CLI::App& verb, scene_options& options, const std::string& group);

// One way or the other was given: else throws what CLI11 makes an error of. To be called by the verb's callback. Then
// options.scene is the one whose polygons are asked for. file: of a verb that has a second positional, else null; where
// SCENE is not given that is the first one.
void settle_scenes(scene_options& options, std::filesystem::path* file = nullptr);

// That of the cells, where it is another one. Tells of warnings and of what it has.
std::optional<scene::scene> load_scene_of_cells(const scene_options& options, progress_line& line);

}  // namespace sightcell::cli
