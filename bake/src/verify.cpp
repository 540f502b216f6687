// The independent check of a bake: its own ray scene built from the import, its own random numbers, no sampler code and
// nothing of the bake's state; the cell sets are read back from the file.
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "bound/clopper_pearson.h"
#include "bound/fresh_rays.h"
#include "bound/metric.h"
#include "host_scene.h"
#include "sightcell/bake/bake.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/scene/error.h"
#include "source/surface_colors.h"
#include "stored_rules.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t reported_polygons = 100;

void require_ok(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::bad_input, "pvs.broken", name, format::status_text(outcome), "bake it again");
}

// One bit per polygon: asked from many threads.
class membership {
 public:
  explicit membership(std::uint32_t polygons) : in_(polygons, 0) {}
  void assign(std::span<const std::uint32_t> set) {
    std::fill(in_.begin(), in_.end(), std::uint8_t{0});
    for (const std::uint32_t polygon : set) in_[polygon] = 1;
    size_ = set.size();
  }
  bool contains(std::uint32_t polygon) const { return in_[polygon] != 0; }
  std::uint64_t size() const { return size_; }

 private:
  std::vector<std::uint8_t> in_;
  std::uint64_t size_ = 0;
};

void note_missing(std::uint32_t cell, const fresh_batch& batch, std::vector<missing_polygon>& missing) {
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

verification verify_cells(const scene::scene& s, const format::reader& file, const std::string& name,
                          const verify_settings& how,
                          const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  // What the bake was told and the check has to know too.
  const stored_rules rules = stored_rules_of(file.settings());
  scene::world_geometry geometry = scene::flatten(s, rules.animated);
  apply_stored_overrides(file.settings(), geometry);
  const ray_scene rays(geometry, rules.all_double_sided);
  std::optional<surface_colors> colors;
  if (how.metric.kind == metric_kind::color) colors.emplace(s, geometry);
  const error_metric metric(how.metric, rays, colors ? &*colors : nullptr);
  const fresh_rules fresh{.player_radius = rules.player_radius, .smallest_gap = rules.smallest_gap, .metric = &metric};
  const std::uint32_t stored = file.cell_count();
  const std::uint32_t chosen = how.cells == 0 ? stored : std::min(how.cells, stored);
  const std::uint64_t rays_each = std::max<std::uint64_t>((how.rays + chosen - 1) / std::max(chosen, 1u), 1);

  verification result;
  membership set(file.polygon_count());
  format::set_reader sets;
  require_ok(sets.open(file), name);
  std::vector<std::uint32_t> seen;
  double visible = 0.0;
  for (std::uint32_t i = 0; i < chosen; ++i) {
    const auto cell = static_cast<std::uint32_t>(std::uint64_t{i} * stored / chosen);
    require_ok(file.check_chunk(format::reader::chunk_of(cell)), name);
    require_ok(sets.source_ids(cell, seen), name);
    set.assign(seen);
    format::box corners;
    require_ok(file.cell_box(cell, corners), name);
    const box grown =
        box{{corners.min[0], corners.min[1], corners.min[2]}, {corners.max[0], corners.max[1], corners.max[2]}}.grown(
            file.facts().margin);
    const fresh_batch batch = cast_fresh_rays(rays, grown, fresh, rays_each, {how.seed, cell, purpose::verify, 0},
                                              [&](std::uint32_t polygon) { return set.contains(polygon); });
    cell_verification one{.cell = cell, .rays = batch.rays, .misses = batch.misses};
    one.error = batch.rays > 0 ? static_cast<double>(batch.misses) / static_cast<double>(batch.rays) : 0.0;
    one.upper_bound = clopper_pearson_upper(batch.misses, batch.rays, result.confidence);
    result.cells.push_back(one);
    result.rays += batch.rays;
    result.misses += batch.misses;
    visible += 100.0 * static_cast<double>(set.size()) / std::max(file.polygon_count(), 1u);
    note_missing(cell, batch, result.missing);
    if (on_progress) on_progress(i + 1, chosen);
  }
  result.pixel_error = result.rays > 0 ? static_cast<double>(result.misses) / static_cast<double>(result.rays) : 0.0;
  result.upper_bound = clopper_pearson_upper(result.misses, result.rays, result.confidence);
  result.visible_set_percent = chosen > 0 ? visible / chosen : 0.0;
  std::stable_sort(result.missing.begin(), result.missing.end(),
                   [](const missing_polygon& a, const missing_polygon& b) { return a.rays > b.rays; });
  if (result.missing.size() > reported_polygons) result.missing.resize(reported_polygons);
  return result;
}

}  // namespace

verification verify(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how, const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  validate_metric(how.metric);
  format::reader opened;
  require_ok(format::reader::open(file, opened), name);
  if (opened.polygon_count() != s.polygon_count || opened.facts().scene_fingerprint != s.fingerprint)
    throw error(error_kind::bad_input, "pvs.other-scene", name, "was baked from another scene than " + s.name,
                "give the scene it was baked from, or bake again");
  verification result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] { result = verify_cells(s, opened, name, how, on_progress); });
  return result;
}

verification verify(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                    const verify_settings& how, const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  require_no_colors(how.metric);
  return verify(scene_of(s), file, name, how, on_progress);
}

}  // namespace sightcell::bake
