// sightcell cells SCENE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "bake_options.h"
#include "cells_glb.h"
#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "sightcell/bake/cells.h"
#include "stop_signals.h"
#include "verbs.h"

namespace sightcell::cli {
namespace {

nlohmann::ordered_json json_of(const bake::cell_preview& preview) {
  nlohmann::ordered_json boxes = nlohmann::ordered_json::array();
  for (const bake::cell_box& cell : preview.cells) {
    nlohmann::ordered_json box;
    if (!cell.name.empty()) box["name"] = cell.name;
    box["min"] = cell.min;
    box["max"] = cell.max;
    boxes.push_back(std::move(box));
  }
  return {{"description", preview.how},
          {"warnings", preview.warnings},
          {"cpu_seconds", preview.cpu_seconds},
          {"polygons_per_cell", preview.polygons_per_cell},
          {"cells", std::move(boxes)}};
}

int run_cells(const bake_options& options, const std::filesystem::path& boxes) {
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
  if (!boxes.empty()) write_cells_glb(preview.cells, boxes);
  if (options.json)
    fmt::print("{}\n", json_of(preview).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else
    fmt::print("{}: {}\n{}: a bake takes about {} of CPU time; a set has about {} of {} polygons\n", s.name,
               preview.how, s.name, duration_text(preview.cpu_seconds),
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
       .examples = {"sightcell cells level.glb", "sightcell cells level.glb --boxes cells.glb"}});
  add_cells_options(verb, *options);
  auto boxes = std::make_shared<std::filesystem::path>();
  add_plain_option(verb, "Output", "--boxes", *boxes, "FILE.glb",
                   "Writes the boxes of the cells as a glTF file, colored by their width.");
  verb.callback([options, boxes, &chosen] {
    settle_scenes(options->scenes);
    chosen = [options, boxes] { return run_cells(*options, *boxes); };
  });
}

}  // namespace sightcell::cli
