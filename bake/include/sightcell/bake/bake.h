#pragma once
// The bake: computes the potentially visible set (PVS) of each view cell of a scene and writes them to a .pvs file.
//
//   const auto s = sightcell::scene::load_gltf("level.glb");           // or the arrays of an engine: host_scene.h
//   sightcell::bake::settings how;                                     // settings.h
//   const auto result = sightcell::bake::bake(s, how, "level.pvs", false, {});
//
// The following conventions hold for all headers of sightcell/bake.
//
// COORDINATES AND UNITS. Axes are those of glTF: right-handed, +Y up. Lengths are in meters, times in seconds,
// positions in world space.
//
// POLYGONS. A polygon is one triangle of one instance of one primitive. Its source id counts all polygons of the scene
// from 0: sightcell/scene/scene.h has the order for glTF, host_scene.h for arrays.
//
// SCENES. Most functions take a scene::scene, which load_gltf makes, or a host_scene, which describes arrays of an
// engine. Both are read during the call and belong to the caller.
//
// FILES. A function that reads a .pvs file takes its bytes, and its name for messages. The bytes are read during the
// call. A function that writes a file writes it under another name in the same folder and renames it at the end:
// readers find the old file or the complete new one.
//
// ERROR BOUND. The miss probability of a cell is the probability that a ray from a random valid viewpoint of the cell,
// in a random direction, meets a polygon that the cell set lacks. Options and fields call it pixel error. A valid
// viewpoint keeps settings::player_radius from every surface and is not inside a solid. A bake casts verification rays
// for each cell until their misses prove an upper bound of at most settings::max_pixel_error.
//
// FAILURES. Functions throw sightcell::error (sightcell/base/error.h): one line with subject, cause, remedy and a
// stable id. bake/ERRORS.md lists the ids. std::bad_alloc when memory is short. What a callback throws passes through.
//
// THREADS. Functions may be called from any thread, several at once. A bake uses settings::threads threads; callbacks
// come on the calling thread, one at a time. Hemicubes of the source `gpu` are drawn on a thread of their own. Its
// headless OpenGL context is made on the calling thread, so the caller must have no other context current there.
//
// REPEATABILITY. Same scene, settings and source of hemicubes: same bytes, for any number of threads or shards and
// after any interruption. Exceptions are settings::time_budget and settings::seconds_per_cell.
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sightcell/bake/host_scene.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

enum class outcome {
  done,           // each cell has its bound
  bound_not_met,  // the file is complete, and some bound of some cells is above settings::max_pixel_error
  cancelled       // by callbacks::on_progress; the same call resumes
};

// How long a cell took.
struct timed_cell {
  std::array<float, 3> center{};  // of its box, meters
  double seconds = 0.0;
};

// How long the cells of a bake took: CPU seconds of the thread that baked a cell, without the help of other threads.
// Without the time of a GPU. Times vary from run to run; nothing in the file depends on them.
struct cell_times {
  std::uint32_t cells = 0;        // counted: all steps of the cell ran in this call
  double median = 0.0;            // 0 where no cell is counted
  double percentile_99 = 0.0;     // 99 of 100 cells took at most this
  double longest = 0.0;           // the slowest cell
  std::array<float, 3> center{};  // of the slowest cell's box, meters
  std::vector<timed_cell> each;   // the counted cells, in the order of the bake
};

// With settings::since: how many cells were baked again, each counted once, by the first of these reasons that holds.
struct rebaked_cells {
  std::uint32_t is_new = 0;           // the earlier bake did not have it
  std::uint32_t changed_polygon = 0;  // it saw a polygon that changed, moved or is gone, or the place of one
  std::uint32_t something_new = 0;    // it could see where something new is
  std::uint32_t neighbors = 0;        // what a neighbor sees changed
  std::uint32_t started = 0;          // the earlier bake started it from what it had (settings::keep_found)
  std::uint32_t kept = 0;             // not baked again

  std::uint32_t count() const { return is_new + changed_polygon + something_new + neighbors + started; }
};

// Which part of the polygons of all sets each step found first, 0 .. 1, in the order of a bake. The sum is 1, or 0 if
// there is none. Polygons that join a set without a test (settings::safety_ring, coarser levels of detail) are left
// out.
struct found_shares {
  double sampler = 0.0;            // hemicubes of the sampler, or its rays
  double touching = 0.0;           // no search: they touch the cell, or are in all sets
  double adjacent_cells = 0.0;     // rays toward what adjacent cells see
  double later_hemicubes = 0.0;    // of the search for the bound
  double nearby_rays = 0.0;        // rays toward the neighbors of visible polygons
  double verification_rays = 0.0;  // which were misses until then
  double reported = 0.0;           // by a host, with --misses
};

// A point of the curve of how the sets grow with the hemicubes of a cell.
struct growth_point {
  std::uint32_t hemicubes = 0;  // number of the first hemicubes of each cell
  double share = 0.0;           // of the polygons of all sets, found first by these hemicubes of each cell; 0 .. 1
  std::uint32_t cells = 0;      // in the file with at least that number
};

// What was found for one of settings::suns.
struct sun_summary {
  double casters_per_cell = 0.0;       // mean number of polygons beside the set of a cell
  double max_upper_bound = 1.0;        // largest bound of a cell: that a point which it sees lacks its shadow
  std::uint32_t cells_over_bound = 0;  // whose bound is above settings::max_pixel_error
  std::uint64_t rays = 0;              // that were spent
};

// What was found with settings::lights.
struct light_summary {
  std::uint32_t lights = 0;         // in the file; 0: the scene has none
  std::uint32_t inside_solids = 0;  // of these: they reach nothing, and have no bound
  double polygons_per_light = 0.0;  // mean number of polygons that a light reaches
  double lights_per_cell = 0.0;     // mean number of lights that touch a cell
  double max_upper_bound = 0.0;     // largest bound of a light outside solids
  std::uint32_t over_bound = 0;     // of these: the bound is above settings::max_pixel_error
  std::uint64_t rays = 0;           // that were spent
};

// Result of a bake, a shard or a merge. Percentages are of all polygons of the scene unless stated otherwise.
struct summary {
  outcome result = outcome::done;

  std::uint32_t cells = 0;             // in the file
  std::uint32_t cells_left_out = 0;    // not in the file: they have no valid viewpoint, or too few for a camera
  std::uint32_t cells_over_bound = 0;  // whose bound is above settings::max_pixel_error
  std::uint32_t cells_resumed = 0;     // taken from the checkpoint of an earlier run

  // Of cells_over_bound: settings::time_budget or settings::seconds_per_cell ended first; the others used all their
  // rays.
  std::uint32_t cells_out_of_time = 0;
  std::uint32_t cells_unreached = 0;  // with settings::time_budget: not in the file, without a bound when it ended

  std::optional<rebaked_cells> rebaked;  // with settings::since

  double visible_percent = 0.0;  // mean size of the cell sets
  found_shares found;            // not counted for a shard

  // At 1, 2, 4, 8 ... hemicubes per cell, up to the largest number of a cell, which is the last point. The last share
  // is that of all hemicubes: rays found the rest (found_shares). Empty for a shard, and if no hemicube was rendered.
  std::vector<growth_point> growth;

  // Polygons that settings::safety_ring added, without a visibility test. 0 for a shard.
  double unseen_per_cell = 0.0;  // mean over the cells
  double unseen_percent = 0.0;   // percent of the polygons that the sets would have without them

  std::uint32_t volumes = 0;      // visibility volumes in the file
  double volumes_per_cell = 0.0;  // mean number of visible volumes
  double slack = 0.0;             // polygons that file_settings::profile added, as a share of the others; 0 .. 0.1

  std::vector<sun_summary> suns;        // one for each of settings::suns
  std::optional<light_summary> lights;  // with settings::lights

  double max_upper_bound = 1.0;  // largest bound of a cell, 0 .. 1
  double cpu_seconds = 0.0;      // of the process during this call, all threads
  cell_times times;              // of single cells; not counted for a shard, or with settings::time_budget
  std::uint64_t bytes = 0;       // size of the file, 0 if there is none
  std::string source;            // of hemicubes: "gpu", "cpu", "rays", or "none" for samplers of rays
  std::string device;            // that made them
};

// Bakes a scene.
// s: the scene.
// how: what to compute; how.cells_from must stay valid during the call.
// output: the .pvs file. It appears when the bake is complete. With a time budget it appears earlier, is replaced by
//   better ones, and remains when the bake is canceled.
// fresh: true discards the checkpoint of an unfinished bake. false resumes it.
// events: progress and log (progress.h); {} for none.
// Returns: see summary.
// Fails with settings.* and cells.* for settings, records.* for settings::since, bake.no-free-cell,
//   bake.nothing-to-see, bake.memory, bake.disk-space,
//   checkpoint.other-bake if the checkpoint has other settings, checkpoint.* and output.* for the disk.
// Files: finished cells are committed to output + ".bake", which is removed at the end. A killed bake resumes there.
//   With settings::keep_records also output + ".records".
// Cost: 0.1 to 1 CPU seconds per cell for scenes of 40,000 to 1,000,000 polygons at a bound of 1e-3 (BENCHMARKS.md).
summary bake(const scene::scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& events);

// As above, for the arrays of an engine. Copies them first.
// Fails also with host.bad-array, and with host.no-colors for metric_kind::color: arrays have no colors.
summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& events);

}  // namespace sightcell::bake
