#include "sightcell/bake/bake.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "bound/fresh_rays.h"
#include "cell_bake.h"
#include "cells/overrides.h"
#include "cells/view_cell.h"
#include "checkpoint.h"
#include "host_scene.h"
#include "process_time.h"
#include "pvs_output.h"
#include "sightcell/scene/error.h"
#include "source/gpu_source.h"

namespace sightcell::bake {
namespace {

// Raised whenever the same settings may give other bytes: old checkpoints are then refused by name.
constexpr int bake_version = 4;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string settings_text(const settings& how, const std::string& device) {
  auto text = nlohmann::ordered_json::parse(describe(how));
  text["device"] = device;
  text["bake_version"] = bake_version;
  return text.dump();
}

std::string checkpoint_key(const scene::scene& s, const std::vector<view_cell>& cells, const overrides& given,
                           const std::string& settings) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  for (const view_cell& cell : cells) {
    const float corners[6] = {cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z};
    XXH3_64bits_update(state, corners, sizeof corners);
    XXH3_64bits_update(state, &cell.place, sizeof cell.place);
  }
  if (const std::uint64_t by_hand = hash_of(given); by_hand != 0) XXH3_64bits_update(state, &by_hand, sizeof by_hand);
  const auto cells_hash = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return fmt::format("scene {:02x} cells {} {:016x} settings {}", fmt::join(s.fingerprint, ""), cells.size(),
                     cells_hash, settings);
}

// Everything a bake needs at hand, in the order in which it is built.
struct workshop {
  scene::world_geometry geometry;
  std::optional<scene::world_geometry> both_sides;  // what the hemicubes draw with --all-double-sided
  std::optional<ray_scene> rays;
  std::optional<near_polygons> neighbors;
  std::unique_ptr<picture::gl_context> context;
  std::unique_ptr<hemicube_source> source;
};

void equip(workshop& w, const scene::scene& s, const settings& how, const overrides& given, const callbacks& tell) {
  w.geometry = scene::flatten(s, how.animated);
  apply(given, w.geometry);
  if (std::all_of(w.geometry.kinds.begin(), w.geometry.kinds.end(),
                  [](const scene::polygon_kind& kind) { return kind.absent; }))
    throw error(error_kind::bad_input, "bake.nothing-to-see", s.name, "has no triangle that could be seen",
                "export meshes with triangles, or name another file");
  w.rays.emplace(w.geometry, how.all_double_sided);
  if (how.max_pixel_error > 0.0) w.neighbors.emplace(*w.rays);
  w.context = std::make_unique<picture::gl_context>();
  const scene::world_geometry* drawn = &w.geometry;
  if (how.all_double_sided) {
    w.both_sides = w.geometry;
    for (scene::polygon_kind& kind : w.both_sides->kinds) kind.double_sided = true;
    drawn = &*w.both_sides;
  }
  // The far plane of the importance: the diagonal of the scene's box.
  const float diagonal = glm::distance(w.geometry.min, w.geometry.max);
  w.source = make_gpu_source(*w.context, *drawn, {.resolution = how.resolution, .far_plane = diagonal});
  if (tell.on_message) {
    for (const std::string& warning : w.geometry.warnings) tell.on_message(severity::warning, warning);
    tell.on_message(severity::note, "device: " + w.source->device());
  }
}

// Times a few hemicubes and rays in cells spread over the list, and says how long the cells that are left will take.
void print_estimate(workshop& w, const std::vector<view_cell>& cells, std::size_t left, const settings& how,
                    const callbacks& tell) {
  if (!tell.on_message || left == 0) return;
  constexpr std::size_t trials = 4;
  constexpr std::uint64_t trial_rays = 2048;
  double hemicube_seconds = 0.0, ray_seconds = 0.0;
  hemicube_view view;
  w.source->render({}, view);  // the first one pays for compiling and uploading
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = cells[i * cells.size() / trials];
    double start = seconds_now();
    w.source->render({.eye = 0.5f * (cell.min + cell.max)}, view);
    hemicube_seconds += (seconds_now() - start) / trials;
    start = seconds_now();
    const auto batch =
        cast_fresh_rays(*w.rays, {cell.min, cell.max}, {how.player_radius, how.smallest_gap}, trial_rays,
                        {how.seed, cell.place, purpose::estimate, 0}, [](std::uint32_t) { return true; });
    if (batch.rays > 0) ray_seconds += (seconds_now() - start) / static_cast<double>(batch.rays) / trials;
  }
  // A first batch that holds needs about 15 / max_pixel_error rays; dilation and second batches about as much again.
  const double rays = how.max_pixel_error > 0.0 ? 30.0 / how.max_pixel_error : 0.0;
  const double per_cell = how.samples * hemicube_seconds + rays * ray_seconds;
  tell.on_message(severity::note,
                  fmt::format("estimate: {} cells, {} hemicubes each at {:.1f} ms{}: about {:.0f} s", left, how.samples,
                              1e3 * hemicube_seconds,
                              rays > 0.0 ? fmt::format(" and rays at {:.1f} us", 1e6 * ray_seconds) : std::string(),
                              std::ceil(per_cell * static_cast<double>(left))));
}

// What is known so far, over the cells of this run and those resumed.
struct tally {
  progress now;
  std::uint64_t rays = 0, misses = 0;
  double visible = 0.0;
  std::uint32_t stored = 0, fresh_cells = 0;

  void count(const cell_record& record, std::uint32_t polygon_count) {
    ++now.cells_done;
    if (!record.stored) return;
    ++stored;
    rays += record.rays;
    misses += record.misses;
    visible += 100.0 * static_cast<double>(record.set.size()) / std::max(polygon_count, 1u);
    now.pixel_error = rays > 0 ? static_cast<double>(misses) / static_cast<double>(rays) : 0.0;
    now.worst_bound = std::max(now.worst_bound, record.rays > 0 ? record.upper_bound : 0.0);
    now.visible_percent = visible / stored;
  }
};

// Bakes what the checkpoint does not have. False when cancelled.
bool bake_cells(workshop& w, const scene::scene& s, const settings& how, const std::vector<view_cell>& cells,
                const overrides& given, checkpoint& done, const callbacks& tell, std::vector<cell_record>& records,
                summary& sum) {
  cell_baker baker(how, *w.rays, w.neighbors ? &*w.neighbors : nullptr, *w.source);
  tally so_far;
  std::uint32_t not_empty = 0;
  so_far.now.cells_total = static_cast<std::uint32_t>(cells.size());
  const double began = seconds_now();
  if (tell.on_progress && !tell.on_progress(so_far.now)) return false;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    auto record = done.load(i);
    const bool resumed = record.has_value();
    if (!resumed) {
      record = baker.bake(cells[i]);
      if (record->stored) add_polygons(given, cells[i].number, record->set);
      done.store(i, *record);
      ++so_far.fresh_cells;
      not_empty += baker.geometry_inside() ? 1 : 0;
    } else {
      ++sum.cells_resumed;
    }
    so_far.count(*record, s.polygon_count);
    records.push_back(std::move(*record));
    so_far.now.seconds = seconds_now() - began;
    const double each = so_far.fresh_cells > 0 ? so_far.now.seconds / so_far.fresh_cells : 0.0;
    so_far.now.seconds_left = each * (so_far.now.cells_total - so_far.now.cells_done);
    if (tell.on_progress && !tell.on_progress(so_far.now) && i + 1 < cells.size()) return false;
  }
  if (tell.on_message && how.max_pixel_error == 0.0 && not_empty > 0)
    tell.on_message(severity::warning,
                    fmt::format("{} cells have geometry inside; without rays (--max-pixel-error 0) polygons "
                                "are missed there however many samples are taken",
                                not_empty));
  return true;
}

}  // namespace

summary bake(const scene::scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);
  const double began = process_cpu_seconds();
  summary sum;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    const overrides given = how.cells_file ? read_overrides(*how.cells_file, s) : overrides{};
    workshop w;
    equip(w, s, how, given, tell);
    sum.device = w.source->device();
    const cell_list list = make_cells(w.geometry, how);
    if (tell.on_message) {
      tell.on_message(severity::note, "cells: " + list.how);
      for (const std::string& warning : list.warnings) tell.on_message(severity::warning, warning);
    }
    const std::string settings = settings_text(how, sum.device);
    std::filesystem::path beside = output;
    beside += ".bake";
    checkpoint done(beside, checkpoint_key(s, list.cells, given, settings), fresh);
    if (tell.on_message && done.finished() > 0)
      tell.on_message(severity::note,
                      fmt::format("resuming: {} of {} cells are done", done.finished(), list.cells.size()));
    print_estimate(w, list.cells, list.cells.size() - done.finished(), how, tell);

    std::vector<cell_record> records;
    if (!bake_cells(w, s, how, list.cells, given, done, tell, records, sum)) {
      sum.result = outcome::cancelled;
      return;
    }
    write_pvs(s, how, with_overrides(settings, given), list.cells, records, output, tell, sum);
    done.remove();
  });
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);  // before alpha functions are called
  return bake(scene_of(s), how, output, fresh, tell);
}

}  // namespace sightcell::bake
