// sightcell bake SCENE -o FILE.pvs
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>

#include "bake_options.h"
#include "bake_outputs.h"
#include "bake_run.h"
#include "console.h"
#include "help.h"
#include "shard_option.h"
#include "stop_signals.h"
#include "verbs.h"
#include "watch/watch_bake.h"

namespace sightcell::cli {

namespace {

int run_bake(const bake_options& options) {
  bake::settings how = settings_of(options);  // fails before minutes of loading
  std::optional<bake::shard> part;
  if (!options.shard.empty()) {
    part = shard_of(options.shard, [](const char* name) -> const char* { return std::getenv(name); });
    part->phase = options.phase;
  }
  refuse_overwriting(options);
  refuse_bad_outputs(options);
  if (!options.embed_file.empty()) refuse_bad_embedding(options);
  outlive_failed_writes();
  if (options.watch) return watch_bake(options);
  progress_line line(progress_mode_of(options.progress));
  const bake_input input = load_input(options, std::move(how), line);
  const stop_signals signals;
  return bake_and_report(options, input, input.how, options.fresh, part ? &*part : nullptr, line,
                         [&] { return signals.asked(); });
}

}  // namespace

void add_bake_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<bake_options>();
  CLI::App& verb = add_verb(
      program, "bake",
      {.summary = "Computes the visibility of a scene and writes a .pvs file",
       .usage = "SCENE -o FILE.pvs [options]",
       .description = "Computes the potentially visible set (PVS) of each view cell of a glTF scene: the polygons that "
                      "can be visible from some viewpoint in the cell. Writes the sets to a .pvs file. A bake that was "
                      "interrupted resumes when the same command runs again.",
       .examples = {"sightcell bake level.glb -o level.pvs",
                    "sightcell bake level.glb -o trial.pvs --cell-limit 16 --quality draft"}});
  add_bake_options(verb, *options);
  verb.callback([options, &chosen] {
    settle_scenes(options->scenes);
    chosen = [options] { return run_bake(*options); };
  });
}

}  // namespace sightcell::cli
