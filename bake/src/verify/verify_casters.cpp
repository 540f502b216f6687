// The independent check of shadow casters: it reads camera sets, caster sets and suns from the file.
#include "sightcell/bake/verify_casters.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <utility>

#include "bound/clopper_pearson.h"
#include "casters/shadow_batch.h"
#include "file/caster_sets.h"
#include "sightcell/base/error.h"
#include "verify/each_cell.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t reported_casters = 100;

void note_missing_casters(std::uint32_t cell, const std::vector<missed_shadow>& missed,
                          std::vector<missing_polygon>& missing) {
  std::map<std::uint32_t, missing_polygon> by_polygon;
  for (const missed_shadow& one : missed) {
    const std::uint32_t polygon = one.lacking.one_of.empty() ? one.lacking.each.front() : one.lacking.one_of.front();
    missing_polygon& entry = by_polygon[polygon];
    if (entry.rays++ > 0) continue;
    entry.cell = cell;
    entry.polygon = polygon;
    entry.eye = {one.eye.x, one.eye.y, one.eye.z};
    entry.target = {one.point.x, one.point.y, one.point.z};
  }
  for (const auto& [polygon, entry] : by_polygon) missing.push_back(entry);
}

class caster_check {
 public:
  caster_check(verified_file& opened, const std::string& name, const verify_settings& how)
      : opened_(opened), name_(name), how_(how), state_(opened.rays().geometry().kinds.size()) {
    const format::status s = casters_.open(opened.file());
    if (s == format::status::absent)
      throw error(error_kind::wrong_use, "pvs.no-casters", name, "has no shadow casters", "bake it with --sun");
    require(s);
    for (std::uint32_t sun = 0; sun < casters_.table().sun_count(); ++sun) {
      format::sun_record r;
      require(casters_.table().sun(sun, r));
      suns_.push_back({{r.from[0], r.from[1], r.from[2]}, {r.to[0], r.to[1], r.to[2]}});
    }
    sets_.camera = [this](std::uint32_t polygon) { return state_[polygon] == seen; };
    sets_.drawn = [this](std::uint32_t polygon) {
      return polygon >= opened_.file().polygon_count() || state_[polygon] != absent;
    };
  }

  std::size_t suns() const { return suns_.size(); }

  void check(std::uint32_t cell, std::size_t sun, std::uint64_t rays, sun_verification& result,
             std::vector<missing_polygon>& missing) {
    std::fill(state_.begin(), state_.end(), absent);
    require(casters_.source_ids(cell, static_cast<std::uint32_t>(sun), ids_));
    for (const std::uint32_t polygon : ids_) state_[polygon] = caster;
    result.drawn_percent += percent(ids_.size());
    opened_.cell_set(cell, ids_);
    for (const std::uint32_t polygon : ids_) state_[polygon] = seen;
    result.drawn_percent += percent(ids_.size());
    result.set_percent += percent(ids_.size());
    const viewpoint_region region = opened_.region(cell);
    // Every viewpoint is tested, so every ray is a trial: no estimate of the valid share is taken from the file.
    shadow_batch batch(opened_.rays(), region, opened_.rules().player_radius, 0.0, suns_[sun],
                       {how_.seed, cell, purpose::caster_verify, sun}, sets_);
    batch.cast(rays);
    const std::uint64_t trials = batch.trials(1e-9);
    result.cells.push_back(
        {.cell = cell,
         .rays = trials,
         .misses = batch.misses(),
         .error = trials > 0 ? static_cast<double>(batch.misses()) / static_cast<double>(trials) : 0.0,
         .upper_bound = clopper_pearson_upper(batch.misses(), trials, 0.95)});
    const caster_sets alone{sets_.camera, [this](std::uint32_t polygon) {
                              return polygon >= opened_.file().polygon_count() || state_[polygon] == seen;
                            }};
    shadow_batch without(opened_.rays(), region, opened_.rules().player_radius, 0.0, suns_[sun],
                         {how_.seed, cell, purpose::caster_verify, sun}, alone);
    without.cast(rays);
    result.misses_of_sets += without.misses();
    result.rays += trials;
    result.misses += batch.misses();
    note_missing_casters(cell, batch.missed(), missing);
  }

 private:
  enum state : std::uint8_t { absent, seen, caster };

  double percent(std::size_t polygons) const {
    return 100.0 * static_cast<double>(polygons) / std::max(opened_.file().polygon_count(), 1u);
  }

  void require(format::status outcome) const {
    if (outcome != format::status::ok)
      throw error(error_kind::bad_input, "pvs.broken", name_, format::status_text(outcome), "bake it again");
  }

  verified_file& opened_;
  const std::string& name_;
  const verify_settings& how_;
  caster_set_reader casters_;
  std::vector<sun_arc> suns_;
  std::vector<state> state_;  // by polygon
  std::vector<std::uint32_t> ids_;
  caster_sets sets_;
};

}  // namespace

caster_verification verify_casters(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                                   const verify_settings& how, const verify_progress& on_progress) {
  verified_file opened(s, how.cells_from, file, name);
  caster_verification result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    opened.build_rays();
    caster_check check(opened, name, how);
    result.suns.resize(check.suns());
    each_cell(opened, how, on_progress, [&](std::uint32_t cell, std::uint64_t rays) {
      for (std::size_t sun = 0; sun < check.suns(); ++sun)
        check.check(cell, sun, rays, result.suns[sun], result.missing);
    });
  });
  for (sun_verification& sun : result.suns) {
    const double cells = std::max<double>(1.0, static_cast<double>(sun.cells.size()));
    sun.set_percent /= cells, sun.drawn_percent /= cells;
    sun.upper_bound = clopper_pearson_upper(sun.misses, sun.rays, result.confidence);
  }
  std::stable_sort(result.missing.begin(), result.missing.end(),
                   [](const missing_polygon& a, const missing_polygon& b) { return a.rays > b.rays; });
  if (result.missing.size() > reported_casters) result.missing.resize(reported_casters);
  return result;
}

}  // namespace sightcell::bake
