#pragma once
// The bake: scene in, .pvs file out. An engine gives its own arrays (host_scene.h); a tool gives what
// scene::load_gltf read.
//
// Threads: the work is spread over all cores (settings::threads), several cells at once where the source of hemicubes
// can be shared; callbacks come on the calling thread, one at a time. Hemicubes of the source gpu are drawn on a
// headless OpenGL context that is current on the calling thread during the call, so none of the host's may be: call
// from a thread that does not render. Several bakes may run at once, from different threads. Failures: sightcell::error
// (sightcell/scene/error.h), one line with id, subject, cause and what to do.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/bake/host_scene.h"
#include "sightcell/bake/settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h, for who loads glTF
struct world_geometry;
}  // namespace sightcell::scene

namespace sightcell::bake {

// Told before the first cell and whenever one has come further; several times a second while a sampler prepares.
struct progress {
  std::uint32_t cells_done = 0, cells_total = 0;  // done: its bound is known and committed
  // Of these: what neighboring cells see was tried too; nothing is left to do. Of a time budget: max_pixel_error is
  // met.
  std::uint32_t cells_checked = 0;
  double importance = 0.0;        // of what is measured for file_settings::importance in the end; before that 0
  double target = 0.0;            // of a time budget: the bound that all cells are being brought to; else 0
  double prepared = 1.0;          // below 1 before the first cell: of what the sampler does for all of them together
  double seconds = 0.0;           // wall clock since the bake began
  double cells_per_second = 0.0;  // of this run; work that has begun counts; 0 until some is committed
  double seconds_left = 0.0;      // for what is left at that rate
  double pixel_error = 0.0;       // pooled misses / rays of the last fresh batches so far
  double worst_bound = 0.0;       // largest upper bound of a finished cell
  double visible_percent = 0.0;   // mean cell set of the cells so far, percent of all polygons
};

enum class severity { note, warning };

// Both are optional and may throw: the bake ends there, and what was finished is kept, as are the cells in work.
struct callbacks {
  std::function<bool(const progress&)> on_progress;  // false cancels, once the cells in work are finished
  // The log: one line of text without a line end. Notes are device, cells, estimate; warnings what may surprise.
  std::function<void(severity, const std::string&)> on_message;
};

enum class outcome { done, bound_not_met, cancelled };

struct summary {
  outcome result = outcome::done;
  std::uint32_t cells = 0;           // stored in the file
  std::uint32_t cells_left_out = 0;  // without a free point
  std::uint32_t cells_over_bound = 0;
  // Of a time budget: over the bound because it was spent; the others' rays were. And cells without a bound, which are
  // not in the file.
  std::uint32_t cells_out_of_time = 0, cells_unreached = 0;
  std::uint32_t cells_resumed = 0;  // taken from the checkpoint
  double visible_percent = 0.0;
  // What the safety ring added, seen by nothing: polygons in the mean over the cells, and all of them in percent of
  // what the sets would hold without it. Of a whole bake or a merge, not of a shard.
  double unseen_per_cell = 0.0, unseen_percent = 0.0;
  std::uint32_t volumes = 0;      // in the file
  double volumes_per_cell = 0.0;  // that are seen
  double slack = 0.0;             // share of polygons that the file's sets hold besides, by its profile
  double max_upper_bound = 1.0;
  double cpu_seconds = 0.0;  // of the process, this run
  std::uint64_t bytes = 0;
  std::string source, device;  // of the hemicubes: gpu, cpu or rays, and on what
};

// Bakes s into output. Finished cells are committed beside it (output + ".bake") as they come; the output appears by
// rename at the end, or not at all when cancelled (then the same call resumes). fresh: an old checkpoint is thrown
// away. With a time budget the output is there before, is replaced by better ones, and holds what there is when
// cancelled. Throws sightcell::error.
summary bake(const scene::scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell);
summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell);

// A part of a bake for one machine of several: the blocks (8 x 8 lattice cells, or one box given by hand) whose number
// leaves index when divided by count. Phase 1 of all shards comes first, in any order; phase 2 reads what it left.
struct shard {
  std::uint32_t index = 0, count = 1;  // index < count, count at most 100,000
  std::uint32_t phase = 1;             // 1 or 2
};

// Where a shard goes: output + ".shard-3-of-16.phase-1".
std::filesystem::path shard_file(const std::filesystem::path& output, const shard& part);
// The shards beside output, of both phases and any count, by name.
std::vector<std::filesystem::path> find_shard_files(const std::filesystem::path& output);

// Bakes a shard into its file, which appears by rename when it is complete; as bake() otherwise. A shard that is there
// already is left alone, but for fresh. Phase 2 reads the phase-1 files beside output. Throws sightcell::error:
// "shard.missing-blocks" names what phase 1 has not baked yet, "shard.other-bake" a file of another bake.
summary bake_shard(const scene::scene& s, const settings& how, const std::filesystem::path& output, const shard& part,
                   bool fresh, const callbacks& tell);
summary bake_shard(const host_scene& s, const settings& how, const std::filesystem::path& output, const shard& part,
                   bool fresh, const callbacks& tell);

// Joins shards into output: the bytes that bake() writes. Needs no scene, no graphics and little memory; shards stay.
// files: in any order, of one bake, any counts; what is in several must be the same. Throws sightcell::error:
// "shard.missing-blocks" names what no file has finished, "shard.doubles-differ", "shard.other-bake", "shard.damaged".
summary merge(std::span<const std::filesystem::path> files, const std::filesystem::path& output, const callbacks& tell);

struct cell_verification {
  std::uint32_t cell = 0;
  std::uint64_t rays = 0, misses = 0;
  double error = 0.0, upper_bound = 1.0;
};

// A polygon that rays saw and the file does not have, with an eye that sees it.
struct missing_polygon {
  std::uint32_t cell = 0, polygon = 0;
  std::uint64_t rays = 0;  // rays that saw it and count as misses
  std::array<float, 3> eye{}, target{};
};

struct verification {
  std::uint64_t rays = 0, misses = 0;
  std::uint64_t misses_of_volumes = 0;  // of the misses: they lack nothing that counts but volumes
  double pixel_error = 0.0, upper_bound = 1.0, confidence = 0.95;  // of the error that the metric says
  double visible_set_percent = 0.0;
  std::vector<cell_verification> cells;
  std::vector<missing_polygon> missing;  // most rays first, at most 100
};

struct verify_settings {
  std::uint32_t cells = 0;         // --cells, at most so many, spread evenly; 0: all
  std::uint64_t rays = 1'000'000;  // --rays, over all cells together, the same number for each
  std::uint64_t seed = 12345;      // --seed
  std::uint32_t threads = 0;
  metric_settings metric = {};  // --metric, what the error is; that of the bake may be another
  // --cells-from: as settings::cells_from of the bake. Outlives the call.
  const scene::scene* cells_from = nullptr;
};

// Casts fresh independent rays against the cell sets of a .pvs file: its own ray scene, no sampler code. A host's scene
// has no colors: metric_kind::color is refused with it, as by bake().
// Where the file has volumes a ray that passes one which its cell's set lacks is a miss, too.
// file: the bytes of the .pvs, read during the call; name: of the file, for messages. Throws sightcell::error when the
// file is broken or belongs to another scene.
verification verify(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how,
                    const std::function<void(std::uint32_t done, std::uint32_t total)>& on_progress);
verification verify(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how,
                    const std::function<void(std::uint32_t done, std::uint32_t total)>& on_progress);

// Polygons first to first + count - 1 (source ids) for one cell of a .pvs file.
struct added_polygons {
  std::uint32_t cell = 0, first = 0, count = 1;
};

struct patch_result {
  std::uint64_t added = 0, already_there = 0;  // polygons, over all cells
  std::uint64_t bytes = 0;                     // of the new file
};

// Adds polygons to cell sets and writes the file to output by rename: the bytes may come from the same file. Bounds and
// certificate stay, because adding only lowers the error; where the
// file has an importance of polygons, what was added is least important. What was new is written into the settings text
// as "added":
// [[cell, first, count], ...]. file, name: as for verify. Throws sightcell::error when the file is broken, a number is
// out of range or the output cannot be written; then nothing was changed.
patch_result patch(std::span<const std::byte> file, const std::string& name, std::span<const added_polygons> additions,
                   const std::filesystem::path& output);

// How many bytes a file would have without its volumes: the same cells and polygons, in the same order. file, name: as
// for verify. Throws sightcell::error when the file is broken.
std::uint64_t size_without_volumes(std::span<const std::byte> file, const std::string& name);

// For who looks at the scene of a .pvs file: what the bake's cells file named as "never" becomes absent, "always"
// always. settings: the text in the file.
void apply_stored_overrides(std::string_view settings, scene::world_geometry& geometry);

// Polygons whose three corners are exactly those of another one. Absent ones do not count.
struct coincident_counts {
  std::uint32_t duplicates = 0;   // of the same kind and facing: seen together, always
  std::uint32_t any_winding = 0;  // whatever the kinds and facings; contains the other two
  std::uint32_t opposite = 0;     // some of those in one place are wound one way, some the other
};

coincident_counts count_coincident(const scene::world_geometry& geometry);

}  // namespace sightcell::bake
