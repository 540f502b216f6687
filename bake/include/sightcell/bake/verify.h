#pragma once
// Measures the miss probability of a .pvs file with verification rays. It uses nothing of the bake: it builds its own
// ray scene, has its own random numbers, and reads the sets from the file. bake.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/host_scene.h"
#include "sightcell/bake/settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// ---- Input ----------------------------------------------------------------------------------------------------------

// What to measure. The names of command line options are those of `sightcell verify`.
struct verify_settings {
  std::uint32_t cells = 0;         // --cells: how many cells, spread evenly over the file; 0 for all
  std::uint64_t rays = 1'000'000;  // --rays: over all cells, the same number for each cell; 1 or more
  std::uint64_t seed = 12345;      // --seed of the random numbers
  std::uint32_t threads = 0;       // 0 for all cores
  metric_settings metric = {};     // --metric: what to measure; may differ from that of the bake

  // --cells-from: the scene of the cells, for files that were baked with settings::cells_from. Null for all others.
  // The caller keeps it during the call.
  const scene::scene* cells_from = nullptr;
};

// Called with the number of cells that are done, on the calling thread. May be empty.
using verify_progress = std::function<void(std::uint32_t done, std::uint32_t total)>;

// ---- Result ---------------------------------------------------------------------------------------------------------

// Result for one cell.
struct cell_verification {
  std::uint32_t cell = 0;
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;
  double error = 0.0;        // misses / rays
  double upper_bound = 1.0;  // of the error of this cell, at verification::confidence
};

// A polygon that rays hit and that is missing from the set of a cell.
struct missing_polygon {
  std::uint32_t cell = 0;
  std::uint32_t polygon = 0;      // source id
  std::uint64_t rays = 0;         // how many rays hit it and count as misses
  std::array<float, 3> eye{};     // the viewpoint of the first of them
  std::array<float, 3> target{};  // where that ray hit
};

// Result for the file. Errors are of verify_settings::metric.
struct verification {
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;
  std::uint64_t misses_of_volumes = 0;  // of misses: only visibility volumes are missing
  double pixel_error = 0.0;             // misses / rays
  double upper_bound = 1.0;             // of the error over all cells, one-sided Clopper-Pearson
  double confidence = 0.95;             // of all upper bounds
  double visible_set_percent = 0.0;     // mean size of the measured sets, percent of all polygons
  std::vector<cell_verification> cells;
  std::vector<missing_polygon> missing;  // at most 100, those with the most rays first
};

// ---- Functions ------------------------------------------------------------------------------------------------------

// Measures a file. In a file with visibility volumes, a ray that passes a volume which the set lacks is a miss too.
// s: the scene that was baked.
// file: the bytes of the .pvs file.
// name: of the file, for messages.
// on_progress: called after each cell.
// Fails with pvs.refused, pvs.broken, pvs.other-scene, pvs.two-scenes, settings.out-of-range for the metric.
// Cost: flattens the scene, builds a ray scene and casts the rays, on how.threads threads.
verification verify(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how, const verify_progress& on_progress);

// As above, for the arrays of an engine. Fails also with host.no-colors for metric_kind::color.
verification verify(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how, const verify_progress& on_progress);

}  // namespace sightcell::bake
