#include "casters/caster_section.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "casters/caster_search.h"
#include "cells/cell_blocks.h"
#include "file/stored_rules.h"
#include "search/coarser_levels.h"
#include "sightcell/base/error.h"
#include "sightcell/format/caster_writer.h"
#include "sightcell/format/set_reader.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {
namespace {

void require_written(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::failed, "output.encode", name, "its shadow casters could not be encoded",
                "report this file");
}

// A cell of the file, and what was found for a sun.
struct lit_cell {
  std::uint32_t number = 0;
  viewpoint_region region{box{}};
  double valid_share = 1.0;
  std::vector<std::uint32_t> camera;
  caster_result found;
};

class caster_section {
 public:
  caster_section(std::span<const std::byte> file, const std::string& name, const settings& how) : name_(name) {
    require_written(format::reader::open(file, file_), name);
    require_written(sets_.open(file_), name);
    for (const sun_setting& sun : how.suns) suns_.push_back(arc_of(sun));
    const stored_rules rules = stored_rules_of(file_.settings());
    how_ = {.max_error = how.max_pixel_error,
            .player_radius = rules.player_radius,
            .seed = rules.seed,
            .own_polygons = file_.polygon_count()};
    find_adjacent();
    casters_.resize(std::size_t{cells()} * suns_.size());
    proofs_.resize(casters_.size());
  }

  std::uint32_t cells() const { return file_.cell_count(); }
  const std::vector<sun_arc>& suns() const { return suns_; }

  void read(std::uint32_t number, lit_cell& cell) {
    format::box corners;
    cell.number = number;
    require_written(file_.cell_box(number, corners), name_);
    const box grown =
        box{{corners.min[0], corners.min[1], corners.min[2]}, {corners.max[0], corners.max[1], corners.max[2]}}.grown(
            file_.facts().margin);
    const auto bytes = file_.viewpoints().region_bytes(number);
    auto region = viewpoint_region::decode(grown, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if (!region) require_written(format::status::corrupt, name_);
    cell.region = std::move(*region);
    cell.valid_share = static_cast<double>(file_.viewpoints().valid_share(number));
    require_written(sets_.source_ids(number, cell.camera), name_);
  }

  // shadows: of the sun.
  void find(const ray_scene& rays, const near_polygons* neighbors, const polygon_shadows& shadows, lit_cell& cell,
            std::size_t sun) const {
    cell.found = find_casters(rays, neighbors, &shadows, with_sun(cell, sun), suns_[sun], how_);
    complete(rays, cell, cell.found.casters);
  }

  // Tries the casters of adjacent cells. To be called when all cells are kept.
  // casters: receives those of the cell, to be kept by replace().
  // Returns the number of rays.
  std::uint64_t try_adjacent(const ray_scene& rays, const near_polygons* neighbors, const lit_cell& cell,
                             std::size_t sun, std::vector<std::uint32_t>& casters) const {
    std::vector<std::uint32_t> candidates;
    for (const std::uint32_t other : adjacent_->neighbors_of(cell.number)) {
      const std::vector<std::uint32_t>& of_other = casters_[other * suns_.size() + sun];
      candidates.insert(candidates.end(), of_other.begin(), of_other.end());
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    casters = casters_[cell.number * suns_.size() + sun];
    const std::uint64_t spent =
        try_casters(rays, neighbors, with_sun(cell, sun), suns_[sun], how_, candidates, casters);
    complete(rays, cell, casters);
    return spent;
  }

  void replace(std::vector<std::vector<std::uint32_t>> casters, std::vector<sun_summary>& found) {
    casters_ = std::move(casters);
    for (std::size_t i = 0; i < casters_.size(); ++i)
      found[i % suns_.size()].casters_per_cell += static_cast<double>(casters_[i].size()) / cells();
  }

  void keep(lit_cell& cell, std::size_t sun, sun_summary& found) {
    caster_result& one = cell.found;
    const std::size_t at = cell.number * suns_.size() + sun;
    proofs_[at] = {.cell = cell.number,
                   .rays = one.rays,
                   .misses = one.misses,
                   .upper_bound = one.upper_bound,
                   .confidence = one.confidence,
                   .seed = how_.seed};
    found.max_upper_bound = std::max(found.max_upper_bound, one.upper_bound);
    found.cells_over_bound += one.bound_met ? 0 : 1;
    found.rays += one.rays_spent;
    casters_[at] = std::move(one.casters);
  }

  std::vector<std::byte> with_section(std::span<const std::byte> file) const {
    format::caster_source source;
    for (const sun_arc& sun : suns_)
      source.suns.push_back({{sun.from.x, sun.from.y, sun.from.z}, {sun.to.x, sun.to.y, sun.to.z}});
    source.get = [this](std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& out) {
      out = casters_[cell * suns_.size() + sun];
      return format::status::ok;
    };
    source.certificate = proofs_;
    std::vector<std::byte> made;
    require_written(format::put_casters(file, source, made), name_);
    return made;
  }

 private:
  static caster_cell with_sun(const lit_cell& cell, std::size_t sun) {
    return {.region = cell.region,
            .valid_share = cell.valid_share,
            .place = std::uint64_t{cell.number} * most_suns + sun,
            .camera = cell.camera};
  }

  // A host draws coarser levels of detail in place of the finest.
  void complete(const ray_scene& rays, const lit_cell& cell, std::vector<std::uint32_t>& casters) const {
    casters.erase(std::lower_bound(casters.begin(), casters.end(), file_.polygon_count()), casters.end());
    add_coarser_levels(rays.geometry().lods, casters);
    std::erase_if(casters, [&](std::uint32_t polygon) {
      return std::binary_search(cell.camera.begin(), cell.camera.end(), polygon);
    });
  }

  void find_adjacent() {
    std::vector<view_cell> boxes(cells());
    for (std::uint32_t number = 0; number < cells(); ++number) {
      format::box corners;
      require_written(file_.cell_box(number, corners), name_);
      boxes[number].min = {corners.min[0], corners.min[1], corners.min[2]};
      boxes[number].max = {corners.max[0], corners.max[1], corners.max[2]};
      boxes[number].place = boxes[number].number = number;
    }
    adjacent_.emplace(boxes, file_.facts().margin);
  }

  const std::string& name_;
  format::reader file_;
  format::set_reader sets_;
  std::optional<cell_blocks> adjacent_;
  std::vector<sun_arc> suns_;
  caster_search_settings how_;
  std::vector<std::vector<std::uint32_t>> casters_;  // the suns of a cell one after the other
  std::vector<format::certificate_record> proofs_;
};

// Reads all cells, a few at a time, so that a cancellation takes effect soon, and calls work for each on the calling
// thread's TBB arena, then keep for each in their order. Returns false if on_done does.
bool for_each_cell(caster_section& section, const std::function<void(lit_cell&)>& work,
                   const std::function<void(lit_cell&)>& keep, const std::function<bool(std::uint32_t done)>& on_done) {
  const auto group = static_cast<std::uint32_t>(std::max(2, 2 * tbb::this_task_arena::max_concurrency()));
  for (std::uint32_t done = 0; done < section.cells();) {
    std::vector<lit_cell> cells(std::min(group, section.cells() - done));
    for (std::uint32_t i = 0; i < cells.size(); ++i) section.read(done + i, cells[i]);
    // A thread that waits for a batch begins no other cell meanwhile.
    tbb::parallel_for(std::size_t{0}, cells.size(),
                      [&](std::size_t i) { tbb::this_task_arena::isolate([&] { work(cells[i]); }); });
    for (lit_cell& cell : cells) keep(cell);
    done += static_cast<std::uint32_t>(cells.size());
    if (!on_done(done)) return false;
  }
  return true;
}

}  // namespace

bool add_casters(std::vector<std::byte>& file, const std::string& name, const ray_scene& rays,
                 const near_polygons* neighbors, const settings& how, const caster_progress& on_progress,
                 std::vector<sun_summary>& found) {
  caster_section section(file, name, how);
  const std::size_t suns = how.suns.size();
  found.assign(suns, {.max_upper_bound = 0.0});
  const auto total = static_cast<std::uint32_t>(section.cells() * suns);
  const auto tell = [&](std::size_t done) {
    return !on_progress || on_progress(static_cast<std::uint32_t>(done), total);
  };
  // One sun after the other, so that the shadows of one are in memory.
  for (std::size_t sun = 0; sun < suns; ++sun) {
    const std::size_t before = sun * section.cells();
    const polygon_shadows shadows =
        shadows_of_polygons(rays, section.suns()[sun].middle(), [&] { return tell(before); });
    const bool all = for_each_cell(
        section, [&](lit_cell& cell) { section.find(rays, neighbors, shadows, cell, sun); },
        [&](lit_cell& cell) { section.keep(cell, sun, found[sun]); },
        [&](std::uint32_t done) { return tell(before + done); });
    if (!all) return false;
  }
  // All cells try what their neighbors had before this step, so that the order of cells does not matter.
  std::vector<std::vector<std::uint32_t>> casters(section.cells() * suns);
  for (std::size_t sun = 0; sun < suns; ++sun) {
    const bool all = for_each_cell(
        section,
        [&](lit_cell& cell) {
          std::vector<std::uint32_t>& of_cell = casters[cell.number * suns + sun];
          cell.found.rays_spent = section.try_adjacent(rays, neighbors, cell, sun, of_cell);
        },
        [&](lit_cell& cell) { found[sun].rays += cell.found.rays_spent; }, [&](std::uint32_t) { return tell(total); });
    if (!all) return false;
  }
  section.replace(std::move(casters), found);
  file = section.with_section(file);
  return true;
}

file_completion casters_of(const settings& how, const ray_scene& rays, const near_polygons* neighbors,
                           const std::filesystem::path& output, const callbacks& events,
                           std::vector<sun_summary>& found) {
  if (how.suns.empty()) return {};
  return [&, neighbors](std::vector<std::byte>& file) {
    if (events.on_phase) events.on_phase(bake_phase::finding_casters);
    return add_casters(
        file, output.string(), rays, neighbors, how,
        [&](std::uint32_t done, std::uint32_t total) {
          progress now;
          now.phase = bake_phase::finding_casters;
          now.cells_done = now.cells_checked = now.cells_total = total;
          now.casters = static_cast<double>(done) / total;
          return !events.on_progress || events.on_progress(now);
        },
        found);
  };
}

}  // namespace sightcell::bake
