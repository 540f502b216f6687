// Merges shards into a file, without the scene and without rays.
#include <fmt/format.h>

#include <vector>

#include "file/pvs_output.h"
#include "shards/shard_files.h"
#include "sightcell/bake/shards.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bake {
namespace {

// Machines whose results differ are detected here.
void check_doubles(const shard_files& files, const bake_plan& plan) {
  files.for_each_double([&](std::uint32_t cell, std::size_t a, std::size_t b) {
    if (files.load_from(a, cell, cell_stage::finished) == files.load_from(b, cell, cell_stage::finished)) return;
    throw error(error_kind::bad_input, "shard.doubles-differ", files.path_of(b).string(),
                fmt::format("differs from {} in {}", files.path_of(a).string(), plan.block_names[plan.block_of[cell]]),
                "bake both shards again, on machines of one kind");
  });
}

void check_complete(const shard_files& files, const bake_plan& plan, const std::filesystem::path& output) {
  std::vector<int> state(plan.block_names.size());  // 0: finished, 1: phase 1 finished, 2: missing
  for (std::uint32_t cell = 0; cell < plan.block_of.size(); ++cell) {
    if (files.file_with(cell, cell_stage::finished)) continue;
    int& block = state[plan.block_of[cell]];
    block = std::max(block, files.file_with(cell, cell_stage::bounded) ? 1 : 2);
  }
  std::vector<std::string> missing, half;
  for (std::size_t block = 0; block < state.size(); ++block)
    if (state[block] != 0) (state[block] == 1 ? half : missing).push_back(plan.block_names[block]);
  if (!missing.empty())
    refuse_missing(missing, output, fmt::format("{} of {} blocks are in no shard", missing.size(), state.size()),
                   "bake the shards that are missing, then merge again");
  if (!half.empty())
    refuse_missing(half, output, fmt::format("{} of {} blocks lack phase 2", half.size(), state.size()),
                   "bake their shards with --phase 2, then merge again");
}

}  // namespace

summary merge(std::span<const std::filesystem::path> files, const std::filesystem::path& output,
              const callbacks& events) {
  const double began = process_cpu_seconds();
  if (files.empty())
    throw error(error_kind::bad_input, "shard.none", output.string(), "has no shards beside it",
                "bake them with --shard first, or name their files");
  const shard_files all(files, std::nullopt);
  const bake_plan plan = all.plan();
  check_complete(all, plan, output);
  check_doubles(all, plan);
  summary sum;
  write_pvs(
      plan.frame, [&](std::uint32_t cell) { return all.load(cell, cell_stage::finished); }, output, events, sum);
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

}  // namespace sightcell::bake
