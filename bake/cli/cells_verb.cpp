// sightcell cells SCENE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bake_options.h"
#include "cells_glb.h"
#include "cells_plan.h"
#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "progress_line.h"
#include "sightcell/bake/cells.h"
#include "sightcell/scene/scene.h"
#include "stop_signals.h"
#include "verbs.h"

namespace sightcell::cli {
namespace {

struct cells_output {
  std::filesystem::path boxes;
  std::string plan;  // the beginning of the names of pictures
};

nlohmann::ordered_json json_of(const bake::cell_preview& preview) {
  nlohmann::ordered_json boxes = nlohmann::ordered_json::array();
  for (const bake::cell_box& cell : preview.cells) {
    nlohmann::ordered_json box;
    if (!cell.name.empty()) box["name"] = cell.name;
    box["min"] = cell.min;
    box["max"] = cell.max;
    boxes.push_back(std::move(box));
  }
  nlohmann::ordered_json floors = nlohmann::ordered_json::array();
  for (const bake::cell_floor& floor : preview.floors)
    floors.push_back({{"lowest", floor.lowest}, {"highest", floor.highest}, {"cells", floor.cells}});
  return {{"description", preview.how},
          {"warnings", preview.warnings},
          {"cpu_seconds", preview.cpu_seconds},
          {"polygons_per_cell", preview.polygons_per_cell},
          {"file_bytes", preview.file_bytes ? nlohmann::ordered_json(std::llround(*preview.file_bytes)) : nullptr},
          {"floors", std::move(floors)},
          {"cells", std::move(boxes)}};
}

// Writes the pictures of --plan.
void write_plan(const bake::cell_preview& preview, const scene::scene& of_cells, const bake::settings& how,
                const std::string& prefix) {
  const scene::world_geometry geometry = scene::flatten(of_cells, how.animated, how.closed);
  std::vector<std::array<float, 3>> starts = how.starts;
  if (starts.empty())
    for (const scene::start_point& start : geometry.starts)
      if (!start.is_camera) starts.push_back(start.position);
  for (const std::filesystem::path& picture : write_cells_plan(preview, geometry, starts, prefix))
    say_line("wrote " + picture.string());
}

int run_cells(const bake_options& options, const cells_output& output) {
  bake::settings how = settings_of(options);  // fails before the scene is loaded
  outlive_failed_writes();
  progress_line line(progress_mode::automatic);
  line.loading(options.scenes.scene);
  const scene::scene s = scene::load_gltf(options.scenes.scene, how.scene);
  const std::optional<scene::scene> of_cells = load_scene_of_cells(options.scenes, line);
  if (of_cells) how.cells_from = &*of_cells;
  const stop_signals signals;
  bake::callbacks events;
  events.on_phase = [&](bake::bake_phase phase) { line.phase(phase); };
  events.on_progress = [&](const bake::progress& now) {
    line.update(now);
    return !signals.asked();
  };
  const std::optional<bake::cell_preview> found = bake::preview_cells(s, how, events);
  line.end();
  if (!found) return exit_cancelled;
  const bake::cell_preview& preview = *found;
  for (const std::string& warning : s.warnings) say_line("warning: " + warning);
  for (const std::string& warning : preview.warnings) say_line("warning: " + warning);
  if (!output.boxes.empty()) write_cells_glb(preview.cells, output.boxes);
  if (!output.plan.empty()) write_plan(preview, of_cells ? *of_cells : s, how, output.plan);
  if (options.json)
    fmt::print("{}\n", json_of(preview).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else
    fmt::print("{}: {}\n{}: a bake takes about {} of CPU time{}; a set has about {} of {} polygons\n", s.name,
               preview.how, s.name, duration_text(preview.cpu_seconds),
               preview.file_bytes ? ", and the file about " + size_text(*preview.file_bytes) : std::string(),
               grouped(static_cast<std::uint64_t>(preview.polygons_per_cell)), grouped(s.polygon_count));
  return exit_done;
}

}  // namespace

void add_cells_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<bake_options>();
  CLI::App& verb = add_verb(
      program, "cells",
      {.summary = "Shows which view cells a bake would have",
       .usage = "SCENE [options]",
       .description = "Finds the view cells that `sightcell bake` with the same options would bake, without a bake: "
                      "how many there are, how they were chosen, and how long the bake takes. With --json, also the "
                      "box of each cell, in the form that --cells-file reads.",
       .examples = {"sightcell cells level.glb", "sightcell cells level.glb --boxes cells.glb",
                    "sightcell cells level.glb --plan cells"}});
  add_cells_options(verb, *options);
  auto output = std::make_shared<cells_output>();
  add_plain_option(verb, "Output", "--boxes", output->boxes, "FILE.glb",
                   "Writes the boxes of the cells as a glTF file, colored by their width.");
  add_plain_option(verb, "Output", "--plan", output->plan, "PREFIX",
                   "Writes a picture from above of each floor with its cells: PREFIX-1.png is the lowest floor.");
  verb.callback([options, output, &chosen] {
    settle_scenes(options->scenes);
    chosen = [options, output] { return run_cells(*options, *output); };
  });
}

}  // namespace sightcell::cli
