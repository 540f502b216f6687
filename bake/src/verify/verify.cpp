// The independent check of a bake: it has a ray scene of its own that is built from the import, its own random
// numbers, no sampler code and no state of the bake. It reads the cell sets from the file.
#include <tbb/task_arena.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "bound/clopper_pearson.h"
#include "bound/metric.h"
#include "bound/verification_rays.h"
#include "hemicube/surface_colors.h"
#include "input/host_scene.h"
#include "input/two_scenes.h"
#include "sightcell/bake/verify.h"
#include "verify/each_cell.h"
#include "verify/verified_file.h"
#include "volumes/stored_volumes.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t reported_polygons = 100;

// The set of one cell. Called from many threads.
class membership {
 public:
  membership(std::uint32_t polygons, std::uint32_t volumes)
      : polygons_(polygons), in_(std::size_t{polygons} + volumes, 0) {}
  // items: polygons, and volumes after them.
  void assign(std::span<const std::uint32_t> items) {
    std::fill(in_.begin(), in_.end(), std::uint8_t{0});
    for (const std::uint32_t item : items) in_[item] = 1;
    size_ = static_cast<std::uint64_t>(std::lower_bound(items.begin(), items.end(), polygons_) - items.begin());
  }
  // Polygons of the other scene are in no set and are not misses.
  bool contains(std::uint32_t polygon) const { return polygon >= polygons_ || in_[polygon] != 0; }
  bool contains_volume(std::uint32_t volume) const { return in_[std::size_t{polygons_} + volume] != 0; }
  std::uint64_t size() const { return size_; }  // polygons

 private:
  std::uint32_t polygons_;
  std::vector<std::uint8_t> in_;
  std::uint64_t size_ = 0;
};

void note_missing(std::uint32_t cell, const verification_batch& batch, std::vector<missing_polygon>& missing) {
  std::map<std::uint32_t, missing_polygon> by_polygon;
  for (const missed_polygon& m : batch.missed) {
    if (!m.counts) continue;
    missing_polygon& entry = by_polygon[m.polygon];
    if (entry.rays++ > 0) continue;
    const glm::vec3 target = m.eye + m.direction * std::min(m.distance, 1e6f);
    entry.cell = cell;
    entry.polygon = m.polygon;
    entry.eye = {m.eye.x, m.eye.y, m.eye.z};
    entry.target = {target.x, target.y, target.z};
  }
  for (const auto& [polygon, entry] : by_polygon) missing.push_back(entry);
}

verification verify_cells(const scene::scene& s, verified_file& opened, const verify_settings& how,
                          const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  opened.build_rays();
  const format::reader& file = opened.file();
  const ray_scene& rays = opened.rays();
  std::optional<surface_colors> colors;
  if (how.metric.kind == metric_kind::color) colors.emplace(s, rays.geometry());
  const error_metric metric(how.metric, rays, colors ? &*colors : nullptr);
  membership set(file.polygon_count(), file.volumes().count());
  const stored_volumes volumes = opened.volumes();
  const std::function<bool(std::uint32_t)> has_volume = [&](std::uint32_t volume) {
    return set.contains_volume(volume);
  };
  const stored_trial trial(volumes, has_volume);
  const visibility_rules fresh{.player_radius = opened.rules().player_radius,
                               .smallest_gap = opened.rules().smallest_gap,
                               .metric = &metric,
                               .volumes = file.volumes().count() > 0 ? &trial : nullptr};

  verification result;
  std::vector<std::uint32_t> seen;
  double visible = 0.0;
  each_cell(opened, how, on_progress, [&](std::uint32_t cell, std::uint64_t rays_of_cell) {
    opened.cell_items(cell, seen);
    set.assign(seen);
    const verification_batch batch =
        cast_verification_rays(rays, opened.region(cell), fresh, rays_of_cell, {how.seed, cell, purpose::verify, 0},
                               [&](std::uint32_t polygon) { return set.contains(polygon); });
    cell_verification one{.cell = cell, .rays = batch.rays, .misses = batch.misses};
    one.error = batch.rays > 0 ? static_cast<double>(batch.misses) / static_cast<double>(batch.rays) : 0.0;
    one.upper_bound = clopper_pearson_upper(batch.misses, batch.rays, result.confidence);
    result.cells.push_back(one);
    result.rays += batch.rays;
    result.misses += batch.misses;
    result.misses_of_volumes += batch.misses_of_volumes;
    visible += 100.0 * static_cast<double>(set.size()) / std::max(file.polygon_count(), 1u);
    note_missing(cell, batch, result.missing);
  });
  result.pixel_error = result.rays > 0 ? static_cast<double>(result.misses) / static_cast<double>(result.rays) : 0.0;
  result.upper_bound = clopper_pearson_upper(result.misses, result.rays, result.confidence);
  if (!result.cells.empty()) result.visible_set_percent = visible / static_cast<double>(result.cells.size());
  std::stable_sort(result.missing.begin(), result.missing.end(),
                   [](const missing_polygon& a, const missing_polygon& b) { return a.rays > b.rays; });
  if (result.missing.size() > reported_polygons) result.missing.resize(reported_polygons);
  return result;
}

}  // namespace

verification verify(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how, const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  validate_metric(how.metric);
  if (how.cells_from != nullptr && how.metric.kind == metric_kind::color) refuse_colors_of_two_scenes("--metric color");
  verified_file opened(s, how.cells_from, file, name);
  verification result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] { result = verify_cells(s, opened, how, on_progress); });
  return result;
}

verification verify(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how, const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  require_no_colors(how.metric);
  return verify(scene_of(s), file, name, how, on_progress);
}

}  // namespace sightcell::bake
