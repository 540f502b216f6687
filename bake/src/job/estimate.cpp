#include "job/estimate.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bound/bound_rays.h"
#include "job/cell_workers.h"
#include "job/file_estimate.h"
#include "job/phases.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/process_time.h"
#include "sightcell/base/stop_request.h"

namespace sightcell::bake {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string time_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", std::ceil(seconds));
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0) : fmt::format("{:.1f} h", seconds / 3600.0);
}

// What the trials of a ray sampler say of a cell.
struct trial_result {
  double sampling_seconds = 0.0;  // on one thread
  double polygons = 0.0;
  std::string sampling;  // how sampling_seconds was computed, for the message
};

// Returns the number of cells in which rays are tried.
std::size_t trials_of(const bake_context& context) {
  return std::min<std::size_t>(context.cells->list.cells.size(), 4);
}

const view_cell& cell_of_trial(const bake_context& context, std::size_t i) {
  const std::vector<view_cell>& cells = context.cells->list.cells;
  return cells[i * cells.size() / trials_of(context)];
}

constexpr std::uint64_t trial_sampling_rays = 65536, trial_rays_for_all = 8192;
constexpr double trial_share_of_rays = 0.1, fewest_trial_rays = 1024, most_trial_rays = 32768;

// Makes a sampler like that of the bake, with fewer rays.
std::unique_ptr<cell_sampler> trial_sampler(const bake_context& context, const settings& how) {
  return make_cell_sampler(how, {context.traced->rays, context.device->source(), nullptr, context.cells->list.cells});
}

// Returns the CPU seconds per ray of a sampler that casts its rays for all cells together.
double try_rays_for_all(const bake_context& context) {
  const std::size_t cells = context.cells->list.cells.size();
  settings how = context.how;
  how.sampling_rays = std::max<std::uint64_t>(trial_rays_for_all / cells, 1);
  const auto sampler = trial_sampler(context, how);
  tbb::task_arena alone(1);
  const double start = thread_cpu_seconds();
  alone.execute([&] { sampler->prepare([](double) { return true; }); });
  return (thread_cpu_seconds() - start) / static_cast<double>(how.sampling_rays * cells);
}

trial_result try_sampling_rays(const bake_context& context) {
  trial_result result;
  const std::size_t trials = trials_of(context);
  settings how = context.how;
  how.sampling_rays = std::min(how.sampling_rays, trial_sampling_rays);
  const bool for_all = how.sampler == "agvs";
  if (for_all) how.sampler = "gvs";  // finds about as much, and can sample a single cell
  const auto sampler = trial_sampler(context, how);
  cell_set set(static_cast<std::uint32_t>(context.input.geometry.kinds.size()), nullptr, context.s.polygon_count);
  tbb::task_arena alone(1);  // so that the time of this thread is all of it
  double seconds = 0.0, cast = 0.0;
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = cell_of_trial(context, i);
    const box where{cell.min, cell.max};
    const std::array<glm::vec3, 1> middle{0.5f * (cell.min + cell.max)};
    set.clear();
    const double start = thread_cpu_seconds();
    alone.execute([&] { cast += static_cast<double>(sampler->sample({where, cell.place, false, middle}, set).rays); });
    seconds += thread_cpu_seconds() - start;
    result.polygons += set.size() / static_cast<double>(trials);
  }
  const double per_ray = for_all ? try_rays_for_all(context) : cast > 0.0 ? seconds / cast : 0.0;
  result.sampling_seconds = static_cast<double>(context.how.sampling_rays) * per_ray;
  result.sampling = fmt::format("{} rays each at {:.1f} us", context.how.sampling_rays, 1e6 * per_ray);
  return result;
}

// Returns the number of verification rays that most cells need: two or three batches, the first of about
// 5 / max_pixel_error rays.
double verification_rays_of_cell(const settings& how) {
  return how.max_pixel_error > 0.0 ? 30.0 / how.max_pixel_error : 0.0;
}

// Returns the wall-clock seconds per verification ray, with all threads of the arena. A small part of the rays of a
// cell is cast: a bake of few cells or few rays must not take longer to estimate than to run.
double try_verification_rays(const bake_context& context) {
  const auto trial_rays = static_cast<std::uint64_t>(
      std::clamp(trial_share_of_rays * verification_rays_of_cell(context.how), fewest_trial_rays, most_trial_rays));
  const settings& how = context.how;
  const std::size_t trials = trials_of(context);
  double seconds = 0.0;
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = cell_of_trial(context, i);
    const double start = seconds_now();
    (void)cast_bound_rays(context.traced->rays, box{cell.min, cell.max}, {how.player_radius, how.smallest_gap},
                          {.trials = trial_rays, .valid_share = 1.0, .risk = 0.01},
                          {how.seed, cell.place, purpose::estimate, 0}, [](std::uint32_t) { return true; });
    seconds += (seconds_now() - start) / static_cast<double>(trial_rays * trials);
  }
  return seconds;
}

bake_estimate estimate_from_rays(const bake_context& context, std::size_t cells_left, const callbacks& events) {
  const settings& how = context.how;
  const trial_result trial = try_sampling_rays(context);
  const double rays = verification_rays_of_cell(how);
  const double ray_seconds = rays > 0.0 ? try_verification_rays(context) : 0.0;
  // The threads bake different cells. The time of a verification ray has all threads already.
  const int at_once = tbb::this_task_arena::max_concurrency();
  const double limit = how.seconds_per_cell > 0.0 ? how.seconds_per_cell : trial.sampling_seconds;
  const double per_cell = std::min(trial.sampling_seconds, limit) / at_once + rays * ray_seconds;
  const double seconds = per_cell * static_cast<double>(cells_left);
  if (events.on_message)
    events.on_message(severity::note,
                      fmt::format("estimate: {} cells, {}{}: about {}", cells_left, trial.sampling,
                                  rays > 0.0 ? fmt::format(" and rays at {:.1f} us", 1e6 * ray_seconds) : std::string(),
                                  time_text(seconds)));
  return {trial.polygons, seconds, seconds * at_once, std::nullopt};
}

constexpr std::size_t fewest_trials = 8, most_trials = 32;
// A trial does not check what neighbors see. Bakes took 1.1 (denhaag_01), 1.2 (czest3ctf) and 1.5 (zdm2) times as long.
constexpr double with_neighbors = 1.3;
constexpr double longest_trials = 10.0;  // seconds, of all

std::size_t trial_count(std::size_t cells, std::size_t cells_left) {
  const std::size_t wanted = cells_left < 80 ? std::max<std::size_t>(cells_left / 10, 1)
                                             : std::clamp<std::size_t>(cells_left / 25, fewest_trials, most_trials);
  return std::min(wanted, cells);
}

std::optional<bake_estimate> estimate_from_cells(const bake_context& context, std::size_t cells_left,
                                                 tbb::task_arena& arena, const callbacks& events, bool with_file) {
  const std::vector<view_cell>& cells = context.cells->list.cells;
  const stage_plan plan(context.cells->blocks, false);
  std::vector<cell_step> steps;
  for (const std::uint32_t cell : choose_trials(cells.size(), trial_count(cells.size(), cells_left)))
    steps.push_back({cell, cell_stage::finished});
  step_queue queue = step_queue::listed(plan, steps);
  const cell_baker baker = baker_of(context);
  stop_request stop;
  const bool whole = context.how.time_budget == 0.0;
  std::vector<stage_record> records;
  bool canceled = false;
  const progress now{.phase = bake_phase::estimating, .cells_total = static_cast<std::uint32_t>(cells.size())};
  const auto device_seconds = [&] { return context.device->source().device_seconds().value_or(0.0); };
  const double cpu_before = process_cpu_seconds(), device_before = device_seconds(), began = seconds_now();
  take_steps(
      queue, [&] { return baker.make_set(); },
      [&](const cell_step& step, cell_set& set) {
        const view_cell& cell = cells[step.cell];
        return whole ? baker.sample_and_finish(cell, set, &stop) : baker.sample(cell, set, &stop);
      },
      workers_for(context, baker, arena, stop),
      [&](std::span<stage_record> ended, std::span<const step_in_work>) {
        std::move(ended.begin(), ended.end(), std::back_inserter(records));
        if (events.on_progress && !events.on_progress(now)) canceled = true;
        return !canceled && (records.size() < fewest_trials || seconds_now() - began < longest_trials);
      });
  if (canceled) return std::nullopt;
  const std::size_t done = records.size();
  double polygons = 0.0;
  for (const stage_record& one : records) polygons += static_cast<double>(one.record.set.size());
  const double factor = with_neighbors / static_cast<double>(done);
  const double cpu = (process_cpu_seconds() - cpu_before) * factor, wall = (seconds_now() - began) * factor;
  const double device = (device_seconds() - device_before) * factor;
  // A few cells do not keep all threads busy to their end, as those of a bake do.
  const double seconds =
      static_cast<double>(cells_left) * std::min(wall, std::max(device, cpu / arena.max_concurrency()));
  if (events.on_message)
    events.on_message(severity::note,
                      fmt::format("estimate: {} cells at {:.2g} s of CPU time: about {}, from {} {}", cells_left, cpu,
                                  time_text(seconds), done, done == 1 ? "cell" : "cells"));
  bake_estimate estimate{polygons / static_cast<double>(done), seconds, cpu * static_cast<double>(cells_left),
                         std::nullopt};
  if (with_file && whole) {
    for (stage_record& one : records)
      if (one.record.stored) one.record = baker.finished(cells[one.cell], std::move(one.record));
    arena.execute([&] { estimate.file_bytes = estimate_file_bytes(context, std::move(records)); });
  }
  return estimate;
}

}  // namespace

std::optional<bake_estimate> estimate_bake(const bake_context& context, std::size_t cells_left, tbb::task_arena& arena,
                                           const callbacks& events, bool with_file) {
  if (cells_left == 0) return bake_estimate{};
  if (takes_hemicubes(context.how.sampler)) return estimate_from_cells(context, cells_left, arena, events, with_file);
  bake_estimate estimate;
  arena.execute([&] { estimate = estimate_from_rays(context, cells_left, events); });
  return estimate;
}

}  // namespace sightcell::bake
