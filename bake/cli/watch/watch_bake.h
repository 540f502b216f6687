#pragma once
// sightcell bake --watch: bakes a scene each time that it is saved.
#include "bake_options.h"

namespace sightcell::cli {

// Runs until SIGINT or SIGTERM. The output is replaced by rename only: at any moment it is the file of an earlier
// version of the scene, or a preview or the file of the current one. A scene that cannot be baked is reported in one
// line, and the output stays. options: of bake, without shards and time budget; settings_of(options) has been called.
// Returns exit_cancelled if a bake was under way, else exit_done.
// Fails with wrong_use for settings, and with scene.not-found if there is no scene at the beginning.
int watch_bake(const bake_options& options);

}  // namespace sightcell::cli
