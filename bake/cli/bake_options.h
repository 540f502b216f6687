#pragma once
// The options of `sightcell bake`.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "metric_options.h"
#include "scene_options.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/animated_as.h"

namespace sightcell::cli {

struct bake_options {
  bake::settings settings;  // what is not below as text or list

  scene_options scenes;
  std::filesystem::path cells_file, misses_file, path_file;
  std::vector<float> cells_grid, eye_heights;
  std::vector<std::string> starts;  // "x,y,z"
  std::vector<std::string> fly;     // "x0,y0,z0,x1,y1,z1"
  std::vector<std::string> suns;    // of --sun
  std::string near;                 // "x,y,z"; empty: none
  std::vector<std::string> path_cameras;
  std::string reach = std::string(bake::reach_names.front());
  std::string quality = std::string(bake::quality_names[static_cast<std::size_t>(bake::quality::normal)]);
  std::optional<double> max_pixel_error;  // instead of the bound of the quality
  metric_options metric;
  std::string animated = std::string(scene::animated_as_names.front());
  std::string safety_ring = std::string(bake::safety_ring_names.front());
  std::string profile = std::string(bake::slack_profile_names[static_cast<std::size_t>(settings.file.profile)]);
  std::string order = std::string(bake::polygon_order_names[static_cast<std::size_t>(settings.file.order)]);
  std::string granularity =
      std::string(bake::set_granularity_names[static_cast<std::size_t>(settings.file.granularity)]);
  std::string layout = std::string(bake::host_layout_names[static_cast<std::size_t>(settings.file.layout)]);

  std::filesystem::path output, json_file, unseen_file, report_file, embed_file;
  bool fresh = false, json = false, watch = false;
  bool keep_order = false;
  std::string shard, progress = "auto";
  std::uint32_t phase = 1;
};

// Adds all options to the verb.
// options: must outlive the verb.
void add_bake_options(CLI::App& verb, bake_options& options);

// Adds the scene and the options that decide which cells there are, and --json.
// options: must outlive the verb.
void add_cells_options(CLI::App& verb, bake_options& options);

// Returns what was asked for. Reads the paths of cameras from the scene, if there are such.
// Fails with settings.*; the line names the option. With paths of cameras also with scene.*.
bake::settings settings_of(const bake_options& options);

}  // namespace sightcell::cli
