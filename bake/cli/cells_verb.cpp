// sightcell cells SCENE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "bake_options.h"
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
  return {{"description", preview.how}, {"warnings", preview.warnings}, {"cells", std::move(boxes)}};
}

int run_cells(const bake_options& options) {
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
  if (options.json)
    fmt::print("{}\n", json_of(preview).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else
    fmt::print("{}: {}\n", s.name, preview.how);
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
                      "how many there are and how they were chosen. With --json, also the box of each cell, in the "
                      "form that --cells-file reads.",
       .examples = {"sightcell cells level.glb", "sightcell cells level.glb --start 0,1,0 --json"}});
  add_cells_options(verb, *options);
  verb.callback([options, &chosen] {
    settle_scenes(options->scenes);
    chosen = [options] { return run_cells(*options); };
  });
}

}  // namespace sightcell::cli
