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

// A cell of the file, and what was found for each sun.
struct lit_cell {
  std::uint32_t number = 0;
  viewpoint_region region{box{}};
  double valid_share = 1.0;
  std::vector<std::uint32_t> camera;
  std::vector<caster_result> by_sun;
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
  }

  std::uint32_t cells() const { return file_.cell_count(); }

  // Finds what all cells ask of each sun. Returns false if keep_going does.
  bool find_shadows(const ray_scene& rays, const std::function<bool()>& keep_going) {
    for (const sun_arc& sun : suns_) {
      shadows_.push_back(shadows_of_polygons(rays, sun.middle(), keep_going));
      if (!keep_going()) return false;
    }
    return true;
  }

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
    cell.by_sun.resize(suns_.size());
  }

  void find(const ray_scene& rays, const near_polygons* neighbors, lit_cell& cell, std::size_t sun) const {
    caster_result& result = cell.by_sun[sun];
    result = find_casters(rays, neighbors, &shadows_[sun], with_sun(cell, sun), suns_[sun], how_);
    complete(rays, cell, result.casters);
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

  void keep(lit_cell& cell, std::vector<sun_summary>& found) {
    for (std::size_t sun = 0; sun < suns_.size(); ++sun) {
      caster_result& one = cell.by_sun[sun];
      proofs_.push_back({.cell = cell.number,
                         .rays = one.rays,
                         .misses = one.misses,
                         .upper_bound = one.upper_bound,
                         .confidence = one.confidence,
                         .seed = how_.seed});
      found[sun].max_upper_bound = std::max(found[sun].max_upper_bound, one.upper_bound);
      found[sun].cells_over_bound += one.bound_met ? 0 : 1;
      found[sun].rays += one.rays_spent;
      casters_.push_back(std::move(one.casters));
    }
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
  std::vector<polygon_shadows> shadows_;  // of each sun
  caster_search_settings how_;
  std::vector<std::vector<std::uint32_t>> casters_;  // the suns of a cell one after the other
  std::vector<format::certificate_record> proofs_;
};

// Calls work for each cell and sun on the calling thread's TBB arena.
void in_parallel(std::size_t cells, std::size_t suns, const std::function<void(std::size_t, std::size_t)>& work) {
  tbb::parallel_for(std::size_t{0}, cells * suns, [&](std::size_t i) {
    // A thread that waits for a batch begins no other cell meanwhile.
    tbb::this_task_arena::isolate([&] { work(i / suns, i % suns); });
  });
}

// Reads all cells, a few at a time, so that a cancellation takes effect soon. Returns false if on_done does.
bool for_groups(caster_section& section, const std::function<void(std::vector<lit_cell>&)>& work,
                const std::function<bool(std::uint32_t done)>& on_done) {
  const auto group = static_cast<std::uint32_t>(std::max(2, 2 * tbb::this_task_arena::max_concurrency()));
  for (std::uint32_t done = 0; done < section.cells();) {
    std::vector<lit_cell> cells(std::min(group, section.cells() - done));
    for (std::uint32_t i = 0; i < cells.size(); ++i) section.read(done + i, cells[i]);
    work(cells);
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
  const auto find = [&](std::vector<lit_cell>& cells) {
    in_parallel(cells.size(), suns,
                [&](std::size_t i, std::size_t sun) { section.find(rays, neighbors, cells[i], sun); });
    for (lit_cell& cell : cells) section.keep(cell, found);
  };
  // All cells try what their neighbors had before this step, so that the order of cells does not matter.
  std::vector<std::vector<std::uint32_t>> casters(section.cells() * suns);
  const auto try_adjacent = [&](std::vector<lit_cell>& cells) {
    std::vector<std::uint64_t> spent(cells.size() * suns);
    in_parallel(cells.size(), suns, [&](std::size_t i, std::size_t sun) {
      std::vector<std::uint32_t>& of_cell = casters[cells[i].number * suns + sun];
      spent[i * suns + sun] = section.try_adjacent(rays, neighbors, cells[i], sun, of_cell);
    });
    for (std::size_t i = 0; i < spent.size(); ++i) found[i % suns].rays += spent[i];
  };
  const auto on_found = [&](std::uint32_t done) { return !on_progress || on_progress(done, section.cells()); };
  const auto on_tried = [&](std::uint32_t) { return on_found(section.cells()); };
  if (!section.find_shadows(rays, [&] { return on_found(0); })) return false;
  if (!for_groups(section, find, on_found) || !for_groups(section, try_adjacent, on_tried)) return false;
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
