#pragma once
// One bake on the command line: from the files of a scene to what is printed about the result.
#include <functional>
#include <optional>
#include <string>

#include "bake_options.h"
#include "progress_line.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/shards.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

class phase_times;

// What a bake is about.
struct bake_input {
  bake::settings how;  // cells_from is not set
  scene::scene s;
  std::optional<scene::scene> of_cells;  // with --cells-from
};

// Loads the scenes, and prints their warnings and counts.
// how: of settings_of(options).
// Fails with scene.*.
bake_input load_input(const bake_options& options, bake::settings how, progress_line& line);

// Bakes, with progress on a line.
// how: the settings, instead of those of the input.
// part: of the output, to bake as a shard; null: all.
// stop: called several times per second; returns true to cancel.
// phases: receives the times, or null.
// Fails as bake::bake.
bake::summary bake_with_progress(const bake_input& input, bake::settings how, const std::filesystem::path& output,
                                 bool fresh, const bake::shard* part, progress_line& line,
                                 const std::function<bool()>& stop, phase_times* phases);

// Bakes as the options ask, and reports the result in all ways that they ask for. Parameters and failures as above.
// Returns an exit code.
int bake_and_report(const bake_options& options, const bake_input& input, bake::settings how, bool fresh,
                    const bake::shard* part, progress_line& line, const std::function<bool()>& stop);

// Writes the file of --embed: the scene as it is on the disk, with the .pvs file of -o.
// Fails with embed.*, scene.* and cli.not-writable; with embed.scene-changed if the scene was saved since it was loaded.
void embed(const bake_options& options, const bake_input& input, progress_line& line);

// Returns the value of --progress.
progress_mode progress_mode_of(const std::string& name);

}  // namespace sightcell::cli
