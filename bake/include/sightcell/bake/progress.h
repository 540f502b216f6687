#pragma once
// How a caller follows a bake, and cancels it.
#include <cstdint>
#include <functional>
#include <string>

namespace sightcell::bake {

// ---- Progress -------------------------------------------------------------------------------------------------------

// State of a bake. Reported before the first cell and after each step of a cell; several times per second while a
// sampler prepares all cells together.
struct progress {
  std::uint32_t cells_done = 0;  // whose bound is known and committed
  std::uint32_t cells_total = 0;
  std::uint32_t cells_checked = 0;  // of cells_done: finished. Time budget: whose bound is at most max_pixel_error

  double importance = 0.0;  // part of the importance that is measured, 0 .. 1; 0 before that begins
  double target = 0.0;      // time budget: the bound that all cells are brought to now; else 0
  double prepared = 1.0;    // part of what the sampler does once for all cells, 0 .. 1; 1 if there is nothing to do

  double seconds = 0.0;           // wall-clock time since the first cell
  double cells_per_second = 0.0;  // of this run, started cells included in part; 0 until a step has ended
  double seconds_left = 0.0;      // estimate from this rate; 0 at the end and while the rate is 0

  double pixel_error = 0.0;      // misses / verification rays of all cells so far, 0 .. 1
  double worst_bound = 0.0;      // largest bound of a cell so far, 0 .. 1
  double visible_percent = 0.0;  // mean size of the cell sets so far, percent of all polygons
};

// ---- Messages -------------------------------------------------------------------------------------------------------

enum class severity {
  note,    // device, cells, estimate of the time
  warning  // what may be a mistake in the scene or the settings
};

// ---- Callbacks ------------------------------------------------------------------------------------------------------

// What a bake calls, on the calling thread and one at a time. Each may be empty. If one throws, the bake stops as if it
// was canceled, and the exception passes through.
struct callbacks {
  // now: valid during the call.
  // Returns false to cancel: cells in work are finished and committed, then the bake returns `outcome::cancelled`.
  std::function<bool(const progress& now)> on_progress;

  // text: one line without a line end.
  std::function<void(severity how_bad, const std::string& text)> on_message;
};

}  // namespace sightcell::bake
