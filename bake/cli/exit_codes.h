#pragma once
// What the process answers to its caller. Kept for ever: scripts test for these numbers.

namespace sightcell::cli {

enum exit_code : int {
  exit_done = 0,
  exit_failed = 1,         // could not be done: disk, device, memory
  exit_wrong_use = 2,      // the command line asks for something that does not exist
  exit_bound_not_met = 3,  // done, but a pixel error bound is above what was asked for
  exit_bad_input = 4,      // an input file is missing, broken, or belongs to another scene
  exit_cancelled = 130,    // Ctrl-C or SIGTERM; what was finished is kept
};

}  // namespace sightcell::cli
