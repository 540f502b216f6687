// Bakes on several machines: each bakes whole blocks, and the files are merged at the end.
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "checkpoint/work_file.h"
#include "file/pvs_output.h"
#include "input/host_scene.h"
#include "job/bake_context.h"
#include "job/bake_key.h"
#include "job/decide_cells.h"
#include "job/disk_space.h"
#include "job/estimate.h"
#include "job/phases.h"
#include "job/progress_tracker.h"
#include "shards/shard_files.h"
#include "sightcell/bake/shards.h"
#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t shard_limit = 100'000;

void validate(const shard& part) {
  if (part.count == 0 || part.count > shard_limit || part.index >= part.count)
    throw error(error_kind::wrong_use, "shard.out-of-range", "--shard", fmt::format("is {}/{}", part.index, part.count),
                fmt::format("give i/n with i from 0 to n - 1 and n at most {}", shard_limit));
  if (part.phase != 1 && part.phase != 2)
    throw error(error_kind::wrong_use, "shard.out-of-range", "--phase", fmt::format("is {}", part.phase),
                "give 1 or 2");
}

// A time budget is one clock for the cells of all blocks.
void refuse_time_budget(const settings& how) {
  if (how.time_budget > 0.0)
    throw error(error_kind::wrong_use, "settings.time-budget", "--time-budget", "is for a bake on one machine",
                "leave out --shard, or --time-budget");
}

// Such sections are made when all sets are known, and merge has no scene.
void refuse_later_sections(const settings& how) {
  if (!how.suns.empty())
    throw error(error_kind::wrong_use, "settings.suns", "--sun", "is for a bake on one machine",
                "leave it out, or bake without --shard");
  if (how.lights)
    throw error(error_kind::wrong_use, "settings.lights", "--lights", "is for a bake on one machine",
                "leave it out, or bake without --shard");
  if (how.file.importance)
    throw error(error_kind::wrong_use, "shard.importance", "--importance", "is for a bake on one machine",
                "leave it out, and add it to the merged file: sightcell recode FILE --importance SCENE");
  if (how.file.residency)
    throw error(error_kind::wrong_use, "shard.residency", "--residency", "is for a bake on one machine",
                "leave it out, and add it to the merged file: sightcell recode FILE --residency SCENE");
}

std::vector<std::uint32_t> blocks_of(const shard& part, const cell_blocks& all) {
  std::vector<std::uint32_t> own;
  for (std::uint32_t block = part.index; block < all.count(); block += part.count) own.push_back(block);
  return own;
}

std::uint32_t cells_in(const std::vector<std::uint32_t>& blocks, const cell_blocks& all) {
  std::size_t cells = 0;
  for (const std::uint32_t block : blocks) cells += all.cells_of(block).size();
  return static_cast<std::uint32_t>(cells);
}

// Returns whether the shard's file exists and is of this bake.
bool is_there(const std::filesystem::path& path, const std::string& key) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return false;
  const std::filesystem::path one[] = {path};
  const shard_files opened(one, key);
  return true;
}

// Returns the cells in the complete file of any shard. All shards of a bake have the same list, so the first file that
// can be read decides.
std::string cells_in_shards(const std::filesystem::path& output) {
  for (const std::filesystem::path& path : find_shard_files(output)) {
    try {
      return checkpoint::open_to_read(path).cells();
    } catch (const error&) {  // phase 2 and merge report what is wrong with the file
    }
  }
  return {};
}

// Returns the cells that an earlier run of this shard stored, or another shard.
std::optional<decided_cells> find_cells(const std::filesystem::path& output, const shard& part,
                                        const std::filesystem::path& scratch, const std::string& inputs) {
  auto cells = decided_from(work_file::stored_cells(shard_file(output, part), scratch), inputs);
  return cells ? std::move(cells) : decided_from(cells_in_shards(output), inputs);
}

// Opens the phase-1 files that phase 2 of these blocks reads; all of them must exist.
shard_files phase_1_of(const std::filesystem::path& output, const stage_plan& plan,
                       const std::vector<std::uint32_t>& blocks, const std::string& key) {
  std::vector<std::filesystem::path> files = find_shard_files(output);
  std::erase_if(files, [](const auto& path) { return path.extension() != ".phase-1"; });
  shard_files found(files, key);
  std::vector<std::uint32_t> missing;
  const cell_blocks& all = plan.blocks();
  const auto need = [&](std::uint32_t cell) {
    if (!found.file_with(cell, plan.end_of_phase_1(cell))) missing.push_back(all.block_of(cell));
  };
  for (const std::uint32_t block : blocks)
    for (const std::uint32_t cell : all.cells_of(block)) {
      need(cell);
      for (const std::uint32_t other : all.neighbors_of(cell)) need(other);
    }
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  if (missing.empty()) return found;
  std::vector<std::string> names;
  for (const std::uint32_t block : missing) names.push_back(all.name_of(block));
  refuse_missing(names, output, fmt::format("phase 1 of {} blocks is missing", names.size()),
                 "bake phase 1 of all shards first");
}

// Checks the disk space for the records and for the final file. The estimated time is logged for phase 1 only.
// Returns the estimated seconds; 0 for phase 2, of which there is no estimate. Returns nothing if the caller canceled.
std::optional<double> check_room(const bake_context& context, unsigned phase, std::size_t cells,
                                 const std::filesystem::path& work, const std::filesystem::path& output,
                                 tbb::task_arena& arena, const callbacks& events) {
  if (cells > 0 && events.on_phase) events.on_phase(bake_phase::estimating);
  const std::optional<bake_estimate> estimate = estimate_bake(context, cells, arena, phase == 1 ? events : callbacks());
  if (!estimate) return std::nullopt;
  const std::uint64_t bytes = cells * checkpoint_bytes_of_cell(estimate->polygons);
  check_disk_space({{folder_of(work), bytes}, {folder_of(output), bytes}}, events);
  return phase == 1 ? estimate->seconds : 0.0;
}

// Bakes one shard from its first cell to its file.
void bake_blocks(const bake_context& context, const stage_plan& plan, const std::vector<std::uint32_t>& blocks,
                 const shard& part, const std::filesystem::path& output, tbb::task_arena& arena, bool fresh,
                 const callbacks& events, summary& sum) {
  const std::filesystem::path target = shard_file(output, part);
  std::optional<shard_files> before;
  if (part.phase == 2) before.emplace(phase_1_of(output, plan, blocks, context.key));
  const pvs_frame frame = context.frame();
  work_file file(target, context.how.scratch, context.key, fresh, encode(plan_of(frame, context.cells->blocks)),
                 context.cell_bytes, stale_test_of(context.key, context.cells->blocks));
  progress_tracker tracker({.polygon_count = context.s.polygon_count,
                            .cells = context.cells->list.cells,
                            .total = sum.cells,
                            .last_phase = static_cast<int>(part.phase)},
                           plan, events);
  resume(file.records(), tracker, events);
  sum.cells_resumed = tracker.resumed();
  const std::optional<double> expected =
      check_room(context, part.phase, tracker.cells_left(), file.path(), output, arena, events);
  if (!expected) {
    sum.result = outcome::cancelled;
    file.copy();  // has the list of cells
    return;
  }
  tracker.expect(*expected);
  const phase_work work{context, plan, blocks, arena, tracker, file};
  keeping(file, [&] {
    tracker.open();
    if (part.phase == 1)
      run_phase_1(work);
    else
      run_phase_2(work, [&](std::uint32_t cell) { return before->load(cell, plan.end_of_phase_1(cell)); });
  });
  sum.visible_percent = tracker.visible_percent();
  sum.max_upper_bound = tracker.worst_bound();
  if (tracker.stopped()) {
    sum.result = outcome::cancelled;
    file.copy();
    return;
  }
  if (events.on_phase) events.on_phase(bake_phase::writing_file);
  file.records().copy_to(target);
  file.remove();
  sum.bytes = std::filesystem::file_size(target);
}

}  // namespace

std::filesystem::path shard_file(const std::filesystem::path& output, const shard& part) {
  std::filesystem::path path = output;
  return path += fmt::format(".shard-{}-of-{}.phase-{}", part.index, part.count, part.phase);
}

std::vector<std::filesystem::path> find_shard_files(const std::filesystem::path& output) {
  const std::string start = output.filename().string() + ".shard-";
  std::vector<std::filesystem::path> found;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(output), none)) {
    const std::string name = entry.path().filename().string();
    const std::string ending = entry.path().extension().string();
    if (name.starts_with(start) && (ending == ".phase-1" || ending == ".phase-2")) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

summary bake_shard(const scene::scene& s, const settings& how, const std::filesystem::path& output, const shard& part,
                   bool fresh, const callbacks& events) {
  validate(how);
  refuse_time_budget(how);
  refuse_later_sections(how);
  validate(part);
  const double began = process_cpu_seconds();
  summary sum;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  std::optional<bake_context> context;
  find_decided find;
  if (!fresh) find = [&](const std::string& inputs) { return find_cells(output, part, how.scratch, inputs); };
  if (!build(context, s, how, {}, find, arena, events)) {
    sum.result = outcome::cancelled;
    return sum;
  }
  sum.source = context->device->chosen.name;
  sum.device = context->device->source().device();
  const stage_plan plan(context->cells->blocks, context->bounds());
  const std::vector<std::uint32_t> blocks = blocks_of(part, context->cells->blocks);
  sum.cells = cells_in(blocks, context->cells->blocks);
  if (events.on_message)
    events.on_message(severity::note,
                      fmt::format("shard {} of {}, phase {}: {} cells in {} of {} blocks", part.index, part.count,
                                  part.phase, sum.cells, blocks.size(), context->cells->blocks.count()));
  if (!fresh && is_there(shard_file(output, part), context->key)) {
    if (events.on_message) events.on_message(severity::note, "its file exists and is complete");
    sum.cells_resumed = sum.cells;
  } else {
    bake_blocks(*context, plan, blocks, part, output, arena, fresh, events, sum);
  }
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

summary bake_shard(const host_scene& s, const settings& how, const std::filesystem::path& output, const shard& part,
                   bool fresh, const callbacks& events) {
  validate(how);  // before alpha functions are called
  require_no_colors(how.metric);
  return bake_shard(scene_of(s), how, output, part, fresh, events);
}

}  // namespace sightcell::bake
