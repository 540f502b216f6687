#include "sightcell/bake/bake.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
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
#include "cell_lanes.h"
#include "cells/overrides.h"
#include "cells/view_cell.h"
#include "checkpoint.h"
#include "host_scene.h"
#include "process_time.h"
#include "pvs_output.h"
#include "sightcell/scene/error.h"
#include "source/choose_source.h"

namespace sightcell::bake {
namespace {

// Raised whenever the same settings may give other bytes: old checkpoints are then refused by name.
constexpr int bake_version = 4;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string settings_text(const settings& how, const chosen_source& eyes) {
  auto text = nlohmann::ordered_json::parse(describe(how));
  text["source"] = eyes.name;
  text["device"] = eyes.source->device();
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
  std::optional<ray_scene> rays;
  std::optional<near_polygons> neighbors;
  chosen_source eyes;
};

void flatten_into(scene::world_geometry& geometry, const scene::scene& s, const settings& how, const overrides& given) {
  geometry = scene::flatten(s, how.animated);
  apply(given, geometry);
  if (std::all_of(geometry.kinds.begin(), geometry.kinds.end(),
                  [](const scene::polygon_kind& kind) { return kind.absent; }))
    throw error(error_kind::bad_input, "bake.nothing-to-see", s.name, "has no triangle that could be seen",
                "export meshes with triangles, or name another file");
}

// Times a few hemicubes and rays in cells spread over the list, and says how long the cells that are left will take.
void print_estimate(workshop& w, const std::vector<view_cell>& cells, std::size_t left, const settings& how,
                    const callbacks& tell) {
  if (!tell.on_message || left == 0) return;
  constexpr std::size_t trials = 4;
  constexpr std::uint64_t trial_rays = 2048;
  double hemicube_seconds = 0.0, ray_seconds = 0.0;
  hemicube_view view;
  w.eyes.source->render({}, view);  // the first one pays for compiling and uploading
  for (std::size_t i = 0; i < trials; ++i) {
    const view_cell& cell = cells[i * cells.size() / trials];
    double start = seconds_now();
    w.eyes.source->render({.eye = 0.5f * (cell.min + cell.max)}, view);
    hemicube_seconds += (seconds_now() - start) / trials;
    start = seconds_now();
    const auto batch =
        cast_fresh_rays(*w.rays, {cell.min, cell.max}, {how.player_radius, how.smallest_gap}, trial_rays,
                        {how.seed, cell.place, purpose::estimate, 0}, [](std::uint32_t) { return true; });
    if (batch.rays > 0) ray_seconds += (seconds_now() - start) / static_cast<double>(batch.rays) / trials;
  }
  // A first batch that holds needs about 15 / max_pixel_error rays; dilation and second batches about as much again.
  const double rays = how.max_pixel_error > 0.0 ? 30.0 / how.max_pixel_error : 0.0;
  // Hemicubes of a shared source are spread over the threads; rays were, when they were timed.
  const int at_once = w.eyes.source->shared() ? tbb::this_task_arena::max_concurrency() : 1;
  const double per_cell = how.samples * hemicube_seconds / at_once + rays * ray_seconds;
  tell.on_message(severity::note,
                  fmt::format("estimate: {} cells, {} hemicubes each at {:.1f} ms{}: about {:.0f} s", left, how.samples,
                              1e3 * hemicube_seconds,
                              rays > 0.0 ? fmt::format(" and rays at {:.1f} us", 1e6 * ray_seconds) : std::string(),
                              std::ceil(per_cell * static_cast<double>(left))));
}

// Finished cells: commits them, counts them and tells of them, all on the calling thread.
class ledger {
 public:
  ledger(std::uint32_t polygon_count, std::size_t cells, const callbacks& tell)
      : polygon_count_(polygon_count), tell_(tell), records_(cells) {
    now_.cells_total = static_cast<std::uint32_t>(cells);
  }

  // Before the first cell. This and the other two answer false when the user has had enough.
  bool open() { return tell_progress(0); }
  bool resume(std::uint32_t which, cell_record record) {
    count(which, std::move(record));
    return tell_progress(0);
  }
  // Cells that end after the user has had enough are still committed.
  bool close(std::uint32_t which, baked_cell& cell, std::size_t in_work, checkpoint& done) {
    done.store(which, cell.record);
    ++fresh_;
    not_empty_ += cell.geometry_inside ? 1 : 0;
    count(which, std::move(cell.record));
    return tell_progress(in_work);
  }

  bool stopped() const { return stopped_; }
  std::uint32_t not_empty() const { return not_empty_; }  // cells of this run with geometry inside
  std::vector<cell_record>& records() { return records_; }

 private:
  void count(std::uint32_t which, cell_record record) {
    ++now_.cells_done;
    if (record.stored) {
      ++stored_;
      rays_ += record.rays;
      misses_ += record.misses;
      visible_ += 100.0 * static_cast<double>(record.set.size()) / std::max(polygon_count_, 1u);
      now_.pixel_error = rays_ > 0 ? static_cast<double>(misses_) / static_cast<double>(rays_) : 0.0;
      now_.worst_bound = std::max(now_.worst_bound, record.rays > 0 ? record.upper_bound : 0.0);
      now_.visible_percent = visible_ / stored_;
    }
    records_[which] = std::move(record);
  }
  bool tell_progress(std::size_t in_work) {
    if (!tell_.on_progress || stopped_) return !stopped_;
    now_.seconds = seconds_now() - began_;
    if (fresh_ > 0) {
      // Those in work are half done, one with the other.
      const double ahead = 0.5 * static_cast<double>(in_work);
      now_.cells_per_second = (fresh_ + ahead) / std::max(now_.seconds, 1e-9);
      now_.seconds_left = (now_.cells_total - now_.cells_done - ahead) / now_.cells_per_second;
    }
    const bool all = now_.cells_done == now_.cells_total && now_.cells_done > 0;
    stopped_ = true;  // also when the callback throws
    stopped_ = !tell_.on_progress(now_) && !all;
    return !stopped_;
  }

  std::uint32_t polygon_count_;
  const callbacks& tell_;
  std::vector<cell_record> records_;
  const double began_ = seconds_now();
  progress now_;  // over the cells of this run and those resumed
  std::uint64_t rays_ = 0, misses_ = 0;
  double visible_ = 0.0;
  std::uint32_t stored_ = 0, fresh_ = 0, not_empty_ = 0;
  bool stopped_ = false;
};

// A bake from its settings to the point where all cells are known.
struct bake_job {
  const scene::scene& s;
  const settings& how;
  const callbacks& tell;
  overrides given;
  workshop w;
  cell_list list;
  std::string settings_text;
  std::unique_ptr<checkpoint> done;
};

void prepare(bake_job& job, const std::filesystem::path& output, bool fresh) {
  const settings& how = job.how;
  const callbacks& tell = job.tell;
  if (how.cells_file) job.given = read_overrides(*how.cells_file, job.s);
  workshop& w = job.w;
  flatten_into(w.geometry, job.s, how, job.given);
  // Cells know nothing of rays, and most of both is one thread's work.
  tbb::parallel_invoke([&] { job.list = make_cells(w.geometry, how); },
                       [&] {
                         w.rays.emplace(w.geometry, how.all_double_sided);
                         if (how.max_pixel_error > 0.0) w.neighbors.emplace(*w.rays);
                       });
  w.eyes = choose_source(how, w.geometry, *w.rays);  // its context belongs to the calling thread
  const std::vector<view_cell>& cells = job.list.cells;
  if (tell.on_message) {
    for (const std::string& warning : w.geometry.warnings) tell.on_message(severity::warning, warning);
    tell.on_message(severity::note, fmt::format("device: {}, source {}{}", w.eyes.source->device(), w.eyes.name,
                                                w.eyes.because.empty() ? std::string() : " (" + w.eyes.because + ")"));
    tell.on_message(severity::note, "cells: " + job.list.how);
    for (const std::string& warning : job.list.warnings) tell.on_message(severity::warning, warning);
  }
  job.settings_text = settings_text(how, job.w.eyes);
  std::filesystem::path beside = output;
  beside += ".bake";
  job.done = std::make_unique<checkpoint>(beside, checkpoint_key(job.s, cells, job.given, job.settings_text), fresh);
  const std::uint32_t finished = job.done->finished();
  if (tell.on_message && finished > 0)
    tell.on_message(severity::note, fmt::format("resuming: {} of {} cells are done", finished, cells.size()));
  print_estimate(job.w, cells, cells.size() - finished, how, tell);
}

// Bakes what the checkpoint does not have. The calling thread is not inside of the arena.
void bake_what_is_left(bake_job& job, tbb::task_arena& arena, ledger& book, summary& sum) {
  const std::vector<view_cell>& cells = job.list.cells;
  std::vector<std::uint32_t> wanted;
  if (!book.open()) return;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    auto record = job.done->load(i);
    if (!record) {
      wanted.push_back(i);
      continue;
    }
    ++sum.cells_resumed;
    if (!book.resume(i, std::move(*record))) return;
  }
  const cell_baker baker(job.how, *job.w.rays, job.w.neighbors ? &*job.w.neighbors : nullptr, *job.w.eyes.source);
  const std::size_t lanes = lane_count(job.w.eyes.source->shared(), arena.max_concurrency(), baker.set_bytes());
  bake_cells(baker, cells, wanted, lanes, arena, [&](std::uint32_t which, baked_cell& cell, std::size_t in_work) {
    if (cell.record.stored) add_polygons(job.given, cells[which].number, cell.record.set);
    return book.close(which, cell, in_work, *job.done);
  });
  if (!book.stopped() && job.tell.on_message && job.how.max_pixel_error == 0.0 && book.not_empty() > 0)
    job.tell.on_message(severity::warning,
                        fmt::format("{} cells have geometry inside; without rays (--max-pixel-error 0) polygons "
                                    "are missed there however many samples are taken",
                                    book.not_empty()));
}

}  // namespace

summary bake(const scene::scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);
  const double began = process_cpu_seconds();
  summary sum;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  bake_job job{.s = s, .how = how, .tell = tell, .given = {}, .w = {}, .list = {}, .settings_text = {}, .done = {}};
  arena.execute([&] { prepare(job, output, fresh); });
  sum.source = job.w.eyes.name;
  sum.device = job.w.eyes.source->device();
  ledger book(s.polygon_count, job.list.cells.size(), tell);
  bake_what_is_left(job, arena, book, sum);
  if (book.stopped()) {
    sum.result = outcome::cancelled;
  } else {
    const std::string text = with_overrides(job.settings_text, job.given);
    arena.execute([&] { write_pvs(s, how, text, job.list.cells, book.records(), output, tell, sum); });
    job.done->remove();
  }
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);  // before alpha functions are called
  return bake(scene_of(s), how, output, fresh, tell);
}

}  // namespace sightcell::bake
