#include "casters/caster_section.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "casters/caster_search.h"
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
  }

  std::uint32_t cells() const { return file_.cell_count(); }

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
    result = find_casters(rays, neighbors,
                          {.region = cell.region,
                           .valid_share = cell.valid_share,
                           .place = std::uint64_t{cell.number} * most_suns + sun,
                           .camera = cell.camera},
                          suns_[sun], how_);
    // A host draws coarser levels of detail in place of the finest.
    std::vector<std::uint32_t>& casters = result.casters;
    casters.erase(std::lower_bound(casters.begin(), casters.end(), file_.polygon_count()), casters.end());
    add_coarser_levels(rays.geometry().lods, casters);
    std::erase_if(casters, [&](std::uint32_t polygon) {
      return std::binary_search(cell.camera.begin(), cell.camera.end(), polygon);
    });
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
      found[sun].casters_per_cell += static_cast<double>(one.casters.size()) / cells();
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
  const std::string& name_;
  format::reader file_;
  format::set_reader sets_;
  std::vector<sun_arc> suns_;
  caster_search_settings how_;
  std::vector<std::vector<std::uint32_t>> casters_;  // the suns of a cell one after the other
  std::vector<format::certificate_record> proofs_;
};

}  // namespace

bool add_casters(std::vector<std::byte>& file, const std::string& name, const ray_scene& rays,
                 const near_polygons* neighbors, const settings& how, const caster_progress& on_progress,
                 std::vector<sun_summary>& found) {
  caster_section section(file, name, how);
  found.assign(how.suns.size(), {.max_upper_bound = 0.0});
  // Few at a time, so that a cancellation takes effect soon.
  const auto group = static_cast<std::uint32_t>(std::max(2, 2 * tbb::this_task_arena::max_concurrency()));
  for (std::uint32_t done = 0; done < section.cells();) {
    std::vector<lit_cell> cells(std::min(group, section.cells() - done));
    for (std::uint32_t i = 0; i < cells.size(); ++i) section.read(done + i, cells[i]);
    tbb::parallel_for(std::size_t{0}, cells.size() * how.suns.size(), [&](std::size_t i) {
      // A thread that waits for a batch begins no other cell meanwhile.
      tbb::this_task_arena::isolate(
          [&] { section.find(rays, neighbors, cells[i / how.suns.size()], i % how.suns.size()); });
    });
    for (lit_cell& cell : cells) section.keep(cell, found);
    done += static_cast<std::uint32_t>(cells.size());
    if (on_progress && !on_progress(done, section.cells())) return false;
  }
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
