// sightcell merge FILE.pvs [SHARD...]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "progress_line.h"
#include "safety_ring_text.h"
#include "sightcell/bake/shards.h"
#include "verbs.h"

namespace sightcell::cli {
namespace {

struct merge_options {
  std::filesystem::path output;
  std::vector<std::filesystem::path> shards;
  bool json = false;
};

int run_merge(const merge_options& options) {
  progress_line line(progress_mode::automatic);
  bake::callbacks events;
  events.on_message = [&line](bake::severity how_bad, const std::string& text) {
    line.message(how_bad == bake::severity::warning ? "warning: " + text : text);
  };
  const std::vector<std::filesystem::path> shards =
      options.shards.empty() ? bake::find_shard_files(options.output) : options.shards;
  events.on_phase = [&line](bake::bake_phase phase) { line.phase(phase); };
  const bake::summary sum = bake::merge(shards, options.output, events);
  line.end();
  if (options.json) {
    const nlohmann::ordered_json text{{"output", options.output.string()},
                                      {"shard_files", shards.size()},
                                      {"cells", sum.cells},
                                      {"cells_left_out", sum.cells_left_out},
                                      {"cells_over_bound", sum.cells_over_bound},
                                      {"visible_set_percent", sum.visible_percent},
                                      {"unseen_per_cell", sum.unseen_per_cell},
                                      {"unseen_percent", sum.unseen_percent},
                                      {"max_upper_bound", sum.max_upper_bound},
                                      {"bytes", sum.bytes}};
    fmt::print("{}\n", text.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  } else {
    line.message(fmt::format("{}: {} cells from {} shard files, {} bytes, {:.3f} % of all polygons visible per cell",
                             options.output.string(), grouped(sum.cells), grouped(shards.size()), grouped(sum.bytes),
                             sum.visible_percent));
    if (sum.unseen_per_cell > 0.0) line.message(safety_ring_text(sum));
  }
  return sum.result == bake::outcome::bound_not_met ? exit_bound_not_met : exit_done;
}

}  // namespace

void add_merge_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<merge_options>();
  CLI::App& verb = add_verb(
      program, "merge",
      {.summary = "Joins the parts (shards) of a bake that ran on several machines",
       .usage = "FILE.pvs [SHARD...] [options]",
       .description = "Joins what sightcell bake --shard has written on several machines, once both phases of all "
                      "shards are complete. The result has the bytes of one bake. No scene is needed.",
       .examples = {"sightcell bake level.glb -o level.pvs --shard 0/2          # on machine 0; 1/2 on machine 1",
                    "sightcell bake level.glb -o level.pvs --shard 0/2 --phase 2", "sightcell merge level.pvs"}});
  verb.add_option("FILE", options->output, "The .pvs file to write.")->required();
  verb.add_option("SHARDS", options->shards, "Files of shards. Without them: those in the folder of FILE.");
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_merge(*options); }; });
}

}  // namespace sightcell::cli
