#pragma once
// A bake on several machines: each machine bakes shards, and merge joins them. The result has the bytes of one bake().
// bake.h has the conventions.
//
//   machine i of n:    bake_shard(s, how, "level.pvs", {i, n, 1}, false, {});
//   once all ended:    bake_shard(s, how, "level.pvs", {i, n, 2}, false, {});
//   once all ended:    merge(find_shard_files("level.pvs"), "level.pvs", {});
//
// All machines see the folder of the output. Scene, settings and output are the same on all of them.
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "sightcell/bake/bake.h"

namespace sightcell::bake {

// ---- Shards ---------------------------------------------------------------------------------------------------------

// A part of a bake. Shard `index` has the blocks whose number leaves the remainder `index` when divided by `count`. A
// block is 8 x 8 lattice cells, or one explicit cell.
struct shard {
  std::uint32_t index = 0;  // 0 .. count - 1
  std::uint32_t count = 1;  // 1 .. 100,000
  std::uint32_t phase = 1;  // 1: sets and bounds; 2: the neighbor check, which needs phase 1 of all shards
};

// Returns the file of a shard: output + ".shard-INDEX-of-COUNT.phase-PHASE".
std::filesystem::path shard_file(const std::filesystem::path& output, const shard& part);

// Returns the files of shards in the folder of output, of both phases and any count, sorted by name. Empty if the
// folder cannot be read.
std::vector<std::filesystem::path> find_shard_files(const std::filesystem::path& output);

// Bakes one shard into its file.
// s, how, fresh, events: as for bake(). how.time_budget, how.file.importance and how.file.residency must
// not be set.
// output: the .pvs file of the whole bake. The file of the shard appears beside it when it is complete. If it is there
//   already and fresh is false, nothing is done.
// part: which shard.
// Returns: summary::cells is the number of cells in the shard.
// Fails with shard.out-of-range, shard.importance, shard.residency, settings.time-budget, shard.missing-blocks (phase 2: the line names
//   what phase 1 has not baked), shard.other-bake (a file of other settings), and as bake().
summary bake_shard(const scene::scene& s, const settings& how, const std::filesystem::path& output, const shard& part,
                   bool fresh, const callbacks& events);

// As above, for the arrays of an engine.
summary bake_shard(const host_scene& s, const settings& how, const std::filesystem::path& output, const shard& part,
                   bool fresh, const callbacks& events);

// ---- Merge ----------------------------------------------------------------------------------------------------------

// Joins the shards of one bake. Needs no scene and no graphics device. The shards stay.
// files: of all blocks and both phases, in any order and of any counts. A block may be in several files.
// output: the .pvs file.
// events: on_message only.
// Fails with shard.missing-blocks (no file has finished them), shard.doubles-differ (files disagree about a block),
//   shard.other-bake, shard.damaged, output.io.
// Cost: reads each file once; memory for the sets of all cells in compressed form.
summary merge(std::span<const std::filesystem::path> files, const std::filesystem::path& output,
              const callbacks& events);

}  // namespace sightcell::bake
