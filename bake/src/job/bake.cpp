#include "sightcell/bake/bake.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <exception>
#include <future>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "casters/caster_section.h"
#include "checkpoint/work_file.h"
#include "file/earlier_file.h"
#include "file/importance_section.h"
#include "file/pvs_output.h"
#include "file/residency_section.h"
#include "input/host_scene.h"
#include "job/bake_context.h"
#include "job/bake_key.h"
#include "job/decide_cells.h"
#include "job/disk_space.h"
#include "job/estimate.h"
#include "job/light_section.h"
#include "job/phases.h"
#include "job/progress_tracker.h"
#include "job/timed_bake.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"
#include "since/step_keeper.h"

namespace sightcell::bake {
namespace {

void warn_of_geometry_inside(const progress_tracker& tracker, const settings& how, const callbacks& events) {
  // Samplers with rays draw new viewpoints inside such cells in every round, so more rays do find what is missing.
  if (!tracker.stopped() && events.on_message && how.max_pixel_error == 0.0 && tracker.not_empty() > 0 &&
      takes_hemicubes(how.sampler))
    events.on_message(severity::warning,
                      fmt::format("{} cells have geometry inside; without rays (--max-pixel-error 0) polygons "
                                  "are missed there however many samples are taken",
                                  tracker.not_empty()));
}

// Checks the disks for the checkpoint, its copy and the file. Also logs the estimate of the time.
// Returns the estimated seconds; nothing if the caller canceled.
std::optional<double> check_room(const bake_context& context, std::uint32_t cells_left, const work_file& file,
                                 const std::filesystem::path& output, tbb::task_arena& arena, const callbacks& events) {
  if (cells_left > 0 && events.on_phase) events.on_phase(bake_phase::estimating);
  // The duration of a bake with a time budget is known: no message.
  const callbacks& listener = context.how.time_budget > 0.0 ? callbacks() : events;
  const std::optional<bake_estimate> estimate = estimate_bake(context, cells_left, arena, listener);
  if (!estimate) return std::nullopt;
  const std::uint64_t of_records = cells_left * checkpoint_bytes_of_cell(estimate->polygons);
  check_disk_space({{folder_of(file.path()), of_records},
                    {folder_of(output), context.cells->blocks.cell_count() * file_bytes_of_cell(estimate->polygons)},
                    {folder_of(output), context.how.scratch.empty() ? 0 : of_records}},
                   events);
  return estimate->seconds;
}

// Returns what keeps the records of the steps; nothing if none are kept. before: of how.since.
std::unique_ptr<step_keeper> keeper_of(bake_context& context, std::optional<kept_records> before) {
  const settings& how = context.how;
  if (!how.keep_records && how.since.empty()) return nullptr;
  if (context.device->chosen.name != "cpu")
    throw error(error_kind::wrong_use, "settings.records", how.since.empty() ? "--keep-records" : "--since",
                "does not work with the source " + context.device->chosen.name, "give --source cpu");
  const volume_grid* volumes = context.volumes_or_null();
  return std::make_unique<step_keeper>(
      context.input.geometry, context.traced->neighbors_or_null(), how, volumes ? volumes->count() : 0,
      steps_key_of(*context.cells, context.settings_text), std::move(before), std::move(*context.edit));
}

// Returns the order of the file of how.order_from; nothing if there is none that fits.
std::optional<earlier_order> order_of(const bake_context& context, const callbacks& events) {
  const std::filesystem::path& from = context.how.order_from;
  if (from.empty()) return std::nullopt;
  const scene::scene& s = context.s;
  const std::vector<std::uint32_t>& new_of = context.edit->polygons.new_of;
  std::string why = "it is of another version of the scene, or has another layout";
  try {
    format::file_parts file = read_earlier_file(from);
    const bool fits =
        file.facts.layout == static_cast<format::host_layout>(context.how.file.layout) && file.clusters.empty();
    if (fits && file.facts.scene_fingerprint == s.fingerprint && file.facts.polygon_count == s.polygon_count) {
      std::vector<std::uint32_t> same(s.polygon_count);
      std::iota(same.begin(), same.end(), 0u);
      return earlier_order{std::move(file), std::move(same)};
    }
    if (fits && file.facts.polygon_count == new_of.size()) return earlier_order{std::move(file), new_of};
  } catch (const error& e) {
    why = e.what();
  }
  if (events.on_message)
    events.on_message(severity::warning, fmt::format("the order of {} is not kept: {}", from.string(), why));
  return std::nullopt;
}

void count_rebaked(const step_keeper& keeper, const settings& how, summary& sum) {
  if (how.since.empty()) return;
  const auto counts = keeper.cells_by_reason();
  const auto of = [&](rebake_reason why) { return counts[static_cast<std::size_t>(why)]; };
  sum.rebaked = rebaked_cells{.is_new = of(rebake_reason::new_cell),
                              .changed_polygon = of(rebake_reason::changed_polygon),
                              .something_new = of(rebake_reason::something_new),
                              .neighbors = of(rebake_reason::neighbors),
                              .started = of(rebake_reason::started),
                              .kept = of(rebake_reason::none)};
}

// Returns what is added to the encoded file.
file_completion completion_of(const bake_context& context, const std::filesystem::path& output, const callbacks& events,
                              summary& sum) {
  return [residency = residency_of(context.how, context.s, context.traced->rays, output, events),
          importance = importance_of(context.how, context.traced->rays, output, events),
          casters = casters_of(context.how, context.traced->rays, context.traced->neighbors_or_null(), output, events,
                               sum.suns),
          lights = lights_of(context, output, events, sum.lights)](std::vector<std::byte>& file) {
    return (!residency || residency(file)) && (!importance || importance(file)) && (!casters || casters(file)) &&
           (!lights || lights(file));
  };
}

// Writes the records of a bake while its file is written, which is mostly the work of one thread.
class records_beside_file {
 public:
  // keeper: null for none.
  records_beside_file(step_keeper* keeper, const std::filesystem::path& output) {
    if (!keeper) return;
    group_.run([this, keeper, output] {
      try {
        written_ = keeper->write(output);
      } catch (...) {
        failed_ = std::current_exception();
      }
    });
  }
  ~records_beside_file() { group_.wait(); }
  records_beside_file(const records_beside_file&) = delete;
  records_beside_file& operator=(const records_beside_file&) = delete;
  // To be called when the file is complete, so that a bake that ends before keeps the records of the earlier one. Fails
  // as step_keeper::write() and written_records::publish().
  void publish() {
    group_.wait();
    if (failed_) std::rethrow_exception(failed_);
    if (written_) written_->publish();
  }

 private:
  std::exception_ptr failed_;
  std::unique_ptr<written_records> written_;
  tbb::task_group group_;
};

// Bakes all cells and writes the file.
// keeper: null for none.
void bake_all(const bake_context& context, const stage_plan& plan, tbb::task_arena& arena, work_file& file,
              const std::filesystem::path& output, const callbacks& events, step_keeper* keeper, summary& sum) {
  std::vector<std::uint32_t> blocks(context.cells->blocks.count());
  std::iota(blocks.begin(), blocks.end(), 0u);
  checkpoint& done = file.records();
  progress_tracker tracker({.polygon_count = context.s.polygon_count,
                            .cells = context.cells->list.cells,
                            .total = context.cells->blocks.cell_count()},
                           plan, events);
  resume(done, tracker, events);
  sum.cells_resumed = tracker.resumed();
  // How many cells an edit changes is not known before, so there is no estimate, and what it costs is saved.
  const std::uint32_t to_estimate = context.how.since.empty() ? tracker.cells_left() : 0;
  const std::optional<double> expected = check_room(context, to_estimate, file, output, arena, events);
  if (!expected) {
    sum.result = outcome::cancelled;
    file.copy();  // has the list of cells
    return;
  }
  tracker.expect(*expected);
  const phase_work work{context, plan, blocks, arena, tracker, file, keeper};
  keeping(file, [&] {
    tracker.open();
    run_both_phases(work);
  });
  sum.times = tracker.times();
  warn_of_geometry_inside(tracker, context.how, events);
  if (tracker.stopped()) {
    sum.result = outcome::cancelled;
    file.copy();
    return;
  }
  const pvs_frame frame = context.frame();
  bool written = false;
  keeping(file, [&] {
    arena.execute([&] {
      records_beside_file records(keeper, output);
      written = write_pvs(
          frame, [&](std::uint32_t cell) { return required(done, cell, cell_stage::finished); }, output, events, sum,
          completion_of(context, output, events, sum));
      if (written) records.publish();
    });
  });
  if (written) {
    const auto over = [](const sun_summary& sun) { return sun.cells_over_bound > 0; };
    if (std::any_of(sum.suns.begin(), sum.suns.end(), over)) sum.result = outcome::bound_not_met;
    if (sum.lights && sum.lights->over_bound > 0) sum.result = outcome::bound_not_met;
    if (keeper) count_rebaked(*keeper, context.how, sum);
    file.remove();
    return;
  }
  sum.result = outcome::cancelled;
  file.copy();
}

}  // namespace

summary bake(const scene::scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& events) {
  validate(how);
  time_budget clock(how.time_budget, how.time_spent);
  const double began = process_cpu_seconds();
  summary sum;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  std::future<kept_records> reading;
  if (!how.since.empty()) reading = std::async(std::launch::async, [&] { return read_records(how.since); });
  std::optional<kept_records> before;
  const earlier_records earlier = [&]() -> const kept_records* {
    if (reading.valid()) before = reading.get();
    return before ? &*before : nullptr;
  };
  std::optional<bake_context> context;
  find_decided find;
  if (!fresh)
    find = [&](const std::string& inputs) {
      return decided_from(work_file::stored_cells(output, how.scratch), inputs);
    };
  if (!build(context, s, how, earlier, find, arena, events)) {
    sum.result = outcome::cancelled;
    return sum;
  }
  context->order = order_of(*context, events);
  sum.source = context->device->chosen.name;
  sum.device = context->device->source().device();

  const stage_plan plan(context->cells->blocks, context->bounds());
  const std::unique_ptr<step_keeper> keeper = keeper_of(*context, std::move(before));
  work_file file(output, how.scratch, context->key, fresh, {}, context->cell_bytes,
                 stale_test_of(context->key, context->cells->blocks));
  if (how.time_budget > 0.0) {
    if (!check_room(*context, context->cells->blocks.cell_count(), file, output, arena, events)) {
      sum.result = outcome::cancelled;
      file.copy();  // has the list of cells
      return sum;
    }
    bake_in_time({*context, plan, arena, clock, file, output, events}, sum);
  } else {
    bake_all(*context, plan, arena, file, output, events, keeper.get(), sum);
  }
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& events) {
  validate(how);  // before the alpha functions of the host are called
  require_no_colors(how.metric);
  return bake(scene_of(s), how, output, fresh, events);
}

}  // namespace sightcell::bake
