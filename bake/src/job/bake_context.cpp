#include "job/bake_context.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bound/bound_rays.h"
#include "input/two_scenes.h"
#include "job/memory_limit.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bake {
namespace {

// Raised whenever the same settings may give other bytes: old checkpoints are then refused by name.
constexpr int bake_version = 14;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string text_of(const settings& how, const chosen_source& eyes) {
  auto text = scene::parse_ordered_json(describe(how));
  text["source"] = eyes.name;
  text["device"] = eyes.source->device();
  text["bake_version"] = bake_version;
  return text.dump();
}

std::string checkpoint_key(const scene::scene& s, const std::vector<view_cell>& cells, const overrides& given,
                           const volume_grid* volumes, const std::string& settings) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  for (const view_cell& cell : cells) {
    const float corners[6] = {cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z};
    XXH3_64bits_update(state, corners, sizeof corners);
    XXH3_64bits_update(state, &cell.place, sizeof cell.place);
  }
  // They are those of all cells, of which --cell-limit may leave out some.
  if (volumes) XXH3_64bits_update(state, volumes->places().data(), volumes->places().size() * sizeof(volume_place));
  if (const std::uint64_t by_hand = hash_of(given); by_hand != 0) XXH3_64bits_update(state, &by_hand, sizeof by_hand);
  const auto cells_hash = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return fmt::format("scene {:02x} cells {} {:016x} settings {}", fmt::join(s.fingerprint, ""), cells.size(),
                     cells_hash, settings);
}

void flatten_into(scene::world_geometry& geometry, const scene::scene& s, const settings& how, const overrides& given) {
  geometry = scene::flatten(s, how.animated);
  apply(given, geometry);
  if (std::all_of(geometry.kinds.begin(), geometry.kinds.end(),
                  [](const scene::polygon_kind& kind) { return kind.absent; }))
    throw error(error_kind::bad_input, "bake.nothing-to-see", s.name, "has no triangle that could be seen",
                "export meshes with triangles, or name another file");
}

void make_cells_and_volumes(bake_context& context) {
  context.list = make_all_cells(context.geometry, context.how);
  if (context.how.volumes > 0.0)
    context.volumes.emplace(context.list.cells, context.how.volumes, double{context.how.margin});
  limit_cells(context.list, context.how.cell_limit);
}

}  // namespace

bake_context::bake_context(const scene::scene& from, const settings& settings_of_bake, const callbacks& tell)
    : s(from), how(settings_of_bake) {
  require_memory(s, how);
  if (how.cells_file) given = read_overrides(*how.cells_file, s);
  if (how.misses_file) misses = reported_misses(read_misses(*how.misses_file, s));
  flatten_into(geometry, s, how, given);
  if (how.cells_from) {
    scene::world_geometry other = scene::flatten(*how.cells_from, how.animated);
    list = make_cells(other, how);
    append(geometry, std::move(other), how.all_double_sided, how.cells_from->name);
  }
  require_memory(s, how, &geometry);
  // Cells know nothing of rays, and most of both is one thread's work.
  tbb::parallel_invoke(
      [&] {
        if (how.cells_from == nullptr) make_cells_and_volumes(*this);
      },
      [&] {
        rays.emplace(geometry, how.all_double_sided);
        if (needs_neighbors(how)) neighbors.emplace(*rays);
      });
  blocks.emplace(list.cells, how.margin);
  eyes = choose_source(how, geometry, *rays);  // its context belongs to the calling thread
  const bool by_color = bounds() && how.metric.kind == metric_kind::color;
  if (how.sampler == "importance-depth-color" || by_color) colors.emplace(s, geometry);
  if (bounds()) metric = error_metric(how.metric, *rays, colors ? &*colors : nullptr);
  sampler = make_cell_sampler(
      how, {*rays, *eyes.source, colors ? &*colors : nullptr, list.cells, neighbors ? &*neighbors : nullptr});
  if (tell.on_message) {
    for (const std::string& warning : geometry.warnings) tell.on_message(severity::warning, warning);
    tell.on_message(severity::note, fmt::format("device: {}, source {}{}", eyes.source->device(), eyes.name,
                                                eyes.because.empty() ? std::string() : " (" + eyes.because + ")"));
    tell.on_message(severity::note, "cells: " + list.how);
    if (volumes) tell.on_message(severity::note, fmt::format("volumes: {} of {:g} m", volumes->count(), how.volumes));
    for (const std::string& warning : list.warnings) tell.on_message(severity::warning, warning);
  }
  settings_text = with_misses(text_of(how, eyes), misses, fmt::format("{}", misses.all().size()));
  settings of_records = how;  // those of a time budget can be gone on with whatever budget
  of_records.time_budget = how.time_budget > 0.0 ? 1.0 : 0.0;
  const std::string of_blocks = misses.key_of(*blocks, list.cells, how.margin);
  key = checkpoint_key(s, list.cells, given, volumes ? &*volumes : nullptr,
                       with_misses(text_of(of_records, eyes), misses, fmt::format("\"{}\"", of_blocks)));
}

stale_key_test bake_context::judge() const {
  return [this](const std::string& stored) -> std::optional<stale_record> {
    const auto changed = blocks_with_other_misses(stored, key);
    if (!changed) return std::nullopt;
    return stale_records(*changed, *blocks);
  };
}

namespace {

// What trials in a few cells say of all.
struct trial_result {
  double sampling_seconds = 0.0;  // per cell, on one thread
  double ray_seconds = 0.0;       // per fresh ray, all threads together
  double polygons = 0.0;          // seen by a cell, or by one of its hemicubes
  std::string sampling;           // what the first number is made of
};

constexpr std::size_t trials = 4;

trial_result try_hemicubes(const bake_context& w) {
  trial_result result;
  hemicube_view view;
  w.eyes.source->render({}, view);  // the first one pays for compiling and uploading
  double seconds = 0.0;
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = w.list.cells[i * w.list.cells.size() / trials];
    const double start = seconds_now();
    w.eyes.source->render({.eye = 0.5f * (cell.min + cell.max)}, view);
    seconds += (seconds_now() - start) / trials;
    const auto own = std::count_if(view.seen.begin(), view.seen.end(),
                                   [&](const seen_polygon& one) { return one.id < w.s.polygon_count; });
    result.polygons += static_cast<double>(own) / trials;
  }
  result.sampling_seconds = w.how.samples * seconds;
  result.sampling = fmt::format("{} hemicubes each at {:.1f} ms", w.how.samples, 1e3 * seconds);
  return result;
}

constexpr std::uint64_t trial_sampling_rays = 65536, trial_rays_for_all = 8192;

// Seconds for one ray of a sampler that casts them for all cells together.
double try_rays_for_all(const bake_context& w) {
  settings how = w.how;
  how.sampling_rays = std::max<std::uint64_t>(trial_rays_for_all / w.list.cells.size(), 1);
  const auto sampler = make_cell_sampler(how, {*w.rays, *w.eyes.source, nullptr, w.list.cells});
  tbb::task_arena alone(1);
  const double start = thread_cpu_seconds();
  alone.execute([&] { sampler->prepare([](double) { return true; }); });
  return (thread_cpu_seconds() - start) / static_cast<double>(how.sampling_rays * w.list.cells.size());
}

trial_result try_sampling_rays(const bake_context& w) {
  trial_result result;
  settings how = w.how;
  how.sampling_rays = std::min(how.sampling_rays, trial_sampling_rays);
  const bool for_all = how.sampler == "agvs";
  if (for_all) how.sampler = "gvs";  // finds about as much, and can be asked for one cell
  const auto sampler = make_cell_sampler(how, {*w.rays, *w.eyes.source, nullptr, w.list.cells});
  cell_set set(static_cast<std::uint32_t>(w.geometry.kinds.size()), nullptr, w.s.polygon_count);
  tbb::task_arena alone(1);  // so that the time of this thread is all of it
  double seconds = 0.0, cast = 0.0;
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = w.list.cells[i * w.list.cells.size() / trials];
    const box where{cell.min, cell.max};
    const std::array<glm::vec3, 1> middle{0.5f * (cell.min + cell.max)};
    set.clear();
    const double start = thread_cpu_seconds();
    alone.execute([&] { cast += static_cast<double>(sampler->sample({where, cell.place, false, middle}, set).rays); });
    seconds += thread_cpu_seconds() - start;
    result.polygons += set.size() / static_cast<double>(trials);
  }
  const double of_ray = for_all ? try_rays_for_all(w) : cast > 0.0 ? seconds / cast : 0.0;
  result.sampling_seconds = static_cast<double>(w.how.sampling_rays) * of_ray;
  result.sampling = fmt::format("{} rays each at {:.1f} us", w.how.sampling_rays, 1e6 * of_ray);
  return result;
}

}  // namespace

double print_estimate(const bake_context& w, std::size_t left, const callbacks& tell) {
  if (left == 0) return 0.0;
  const settings& how = w.how;
  trial_result result = takes_hemicubes(how.sampler) ? try_hemicubes(w) : try_sampling_rays(w);
  constexpr std::uint64_t trial_rays = 32768;  // so that the places which are tested anyway do not decide
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = w.list.cells[i * w.list.cells.size() / trials];
    const double start = seconds_now();
    (void)cast_bound_rays(*w.rays, {cell.min, cell.max}, {how.player_radius, how.smallest_gap},
                          {.trials = trial_rays, .valid_share = 1.0, .risk = 0.01},
                          {how.seed, cell.place, purpose::estimate, 0}, [](std::uint32_t) { return true; });
    result.ray_seconds += (seconds_now() - start) / static_cast<double>(trial_rays) / trials;
  }
  // Most cells need two or three batches, the first of about 5 / max_pixel_error rays.
  const double rays = how.max_pixel_error > 0.0 ? 30.0 / how.max_pixel_error : 0.0;
  // Cells of a shared source are spread over the threads; fresh rays were, when they were timed.
  const int at_once = w.eyes.source->shared() ? tbb::this_task_arena::max_concurrency() : 1;
  const double limit = how.seconds_per_cell > 0.0 ? how.seconds_per_cell : result.sampling_seconds;
  const double per_cell = std::min(result.sampling_seconds, limit) / at_once + rays * result.ray_seconds;
  if (!tell.on_message) return result.polygons;
  tell.on_message(
      severity::note,
      fmt::format("estimate: {} cells, {}{}: about {:.0f} s", left, result.sampling,
                  rays > 0.0 ? fmt::format(" and rays at {:.1f} us", 1e6 * result.ray_seconds) : std::string(),
                  std::ceil(per_cell * static_cast<double>(left))));
  return result.polygons;
}

}  // namespace sightcell::bake
