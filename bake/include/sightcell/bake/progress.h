#pragma once
// How a caller follows a bake, and cancels it.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace sightcell::bake {

// ---- Phases ---------------------------------------------------------------------------------------------------------

// What a bake is doing. The phases come in this order; those with nothing to do are left out.
enum class bake_phase {
  loading,               // reads the files that the settings name, and makes world geometry from the scene
  finding_cells,         // and builds what rays are cast in and hemicubes are rendered from
  preparing_hemicubes,   // the rest of that, once cells are found
  merging_cells,         // that see nearly the same polygons
  estimating,            // time and disk space, from a few trials
  preparing_sampler,     // what the sampler does once for all cells; few samplers do
  baking_cells,          // until the bound of each is known
  checking_neighbors,    // tests in each cell what adjacent cells found
  writing_file,          // orders and encodes the sets
  measuring_importance,  // settings::file.importance
  finding_casters,       // settings::suns
  finding_lights,        // settings::lights
};

// ---- Progress -------------------------------------------------------------------------------------------------------

// A cell that has been in work for long.
struct slow_cell {
  std::uint32_t cell = 0;         // in the order of the bake's cells, from 0; a .pvs file has an order of its own
  std::array<float, 3> center{};  // of its box, meters
  double seconds = 0.0;           // in work, without interruption
};

// A cell whose bound is known now.
struct bounded_cell {
  std::uint32_t cell = 0;             // in the order of the bake's cells, from 0
  std::array<float, 3> min{}, max{};  // corners of its box, meters
  std::uint64_t polygons = 0;         // of its set; the check with the cells around may add some
  double bound = 1.0;                 // of its miss probability, 0 .. 1
  // That its steps took: CPU time, with the source `gpu` wall-clock time. Negative if an earlier run has begun the
  // cell.
  double seconds = -1.0;
};

// State of a bake. Reported before the first cell, after each step of a cell, and several times per second while cells
// are in work or a sampler prepares all cells together.
struct progress {
  bake_phase phase = bake_phase::baking_cells;

  std::uint32_t cells_done = 0;  // whose bound is known and committed
  std::uint32_t cells_total = 0;
  std::uint32_t cells_checked = 0;  // of cells_done: finished. Time budget: whose bound is at most max_pixel_error
  std::uint32_t cells_in_work = 0;  // now

  double lights = 0.0;      // part of the lights whose polygons are found, 0 .. 1; 0 before that begins
  double casters = 0.0;     // part of the cells whose shadow casters are found, 0 .. 1; 0 before that begins
  double importance = 0.0;  // part of the importance that is measured, 0 .. 1; 0 before that begins
  double target = 0.0;      // time budget: the bound that all cells are brought to now; else 0
  // Part that is done of merging cells, or of what the sampler does once for all cells, 0 .. 1; 1 if there is nothing
  // to do.
  double prepared = 1.0;

  double seconds = 0.0;           // wall-clock time since the first cell, or since merging began
  double cells_per_second = 0.0;  // of this run, started cells included in part; 0 until a step has ended
  // Estimated from this rate, and before the first step has ended from trials. 0: at the end, or unknown because the
  // only cells that are left take longer than the trials suggest.
  double seconds_left = 0.0;

  double pixel_error = 0.0;      // misses / verification rays of all cells so far, 0 .. 1
  double worst_bound = 0.0;      // largest bound of a cell so far, 0 .. 1
  double visible_percent = 0.0;  // mean size of the cell sets so far, percent of all polygons

  // The cells whose bound became known since the last report, first those of an earlier run; no cell without a valid
  // viewpoint. Empty with settings::time_budget, where bounds get better over the whole bake.
  std::span<const bounded_cell> bounded = {};

  std::optional<slow_cell> slow = {};  // the cell longest in work, from 10 seconds on; always there in on_stopping
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
  // now: valid during the call. While cells are found and merged there are none yet, and cells_total is 0.
  // Returns false to cancel: cells in work end within a second and are not committed; the bake returns
  // `outcome::cancelled`.
  std::function<bool(const progress& now)> on_progress = {};

  // text: one line without a line end.
  std::function<void(severity how_bad, const std::string& text)> on_message = {};

  // A phase begins. `progress::phase` has the same value from now on.
  std::function<void(bake_phase phase)> on_phase = {};

  // on_progress has canceled, and cells are still in work. Called several times per second until they end; not called
  // with the source `gpu`.
  std::function<void(const progress& now)> on_stopping = {};
};

}  // namespace sightcell::bake
