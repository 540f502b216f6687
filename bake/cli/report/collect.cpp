#include "report/collect.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "file_info.h"
#include "report/data_uri.h"
#include "report/suggestions.h"
#include "report/views.h"
#include "sightcell/bake/cell_views.h"
#include "sightcell/bake/stored_overrides.h"
#include "sightcell/bake/unseen.h"
#include "sightcell/bake/verify.h"
#include "sightcell/picture/floor_plan.h"
#include "verify_result.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

constexpr std::uint64_t view_seed = 1;
constexpr std::uint32_t longest_plan = 900;  // pixels

std::vector<report_cell> cells_of(const pvs_file& file) {
  format::set_reader sets = file.sets();
  std::vector<report_cell> cells(file.content().cell_count());
  std::vector<std::uint32_t> set;
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    const format::box box = file.cell_box(cell);
    cells[cell].min = box.min;
    cells[cell].max = box.max;
    file.check(sets.source_ids(cell, set));
    cells[cell].polygons = set.size();
  }
  for (std::uint32_t i = 0; i < file.content().certificate_count(); ++i) {
    format::certificate_record record;
    file.check(file.content().certificate(i, record));
    report_cell& cell = cells.at(record.cell);
    cell.rays = record.rays;
    cell.misses = record.misses;
    cell.bound = record.upper_bound;
    cell.confidence = record.confidence;
  }
  return cells;
}

// Sets the seconds of cells whose middle is that of a cell of the bake, to the millimeter.
void add_seconds(const bake::cell_times& times, std::vector<report_cell>& cells) {
  using place = std::array<long, 3>;
  const auto place_of = [](const std::array<float, 3>& at) {
    return place{std::lround(1000.0f * at[0]), std::lround(1000.0f * at[1]), std::lround(1000.0f * at[2])};
  };
  std::map<place, double> seconds;
  for (const bake::timed_cell& one : times.each) seconds.emplace(place_of(one.center), one.seconds);
  for (report_cell& cell : cells) {
    std::array<float, 3> center{};
    for (std::size_t axis = 0; axis < 3; ++axis) center[axis] = 0.5f * (cell.min[axis] + cell.max[axis]);
    if (const auto found = seconds.find(place_of(center)); found != seconds.end()) cell.seconds = found->second;
  }
}

bool is_over_floors(const ordered_json& info) {
  const auto settings = info.find("settings");
  return settings != info.end() && settings->is_object() && settings->value("cells", ordered_json()) == "automatic";
}

picture::plan_rectangle rectangle_in_plan(const report_cell& cell) {
  return {cell.min[0], cell.min[2], cell.max[0], cell.max[2]};
}

// How far the floor is below the bottom of each cell: players stand there. 0 for cells of a caller.
double ground_below(const report_data& data) {
  constexpr double lowest_eye = 0.9;
  return is_over_floors(data.info) ? lowest_eye : 0.0;
}

void add_floors(const scene::world_geometry& world, report_data& data) {
  if (data.cells.empty()) return;
  std::vector<bake::cell_box> boxes;
  for (const report_cell& cell : data.cells) boxes.push_back({.name = {}, .min = cell.min, .max = cell.max});
  const double below = ground_below(data);
  picture::plan_rectangle frame = rectangle_in_plan(data.cells.front());
  for (const report_cell& cell : data.cells) {
    const picture::plan_rectangle r = rectangle_in_plan(cell);
    frame = {std::min(frame.min_x, r.min_x), std::min(frame.min_z, r.min_z), std::max(frame.max_x, r.max_x),
             std::max(frame.max_z, r.max_z)};
  }
  const picture::plan_rectangle extent = picture::plan_extent(frame);
  data.frame = {extent.min_x, extent.min_z, extent.max_x, extent.max_z};
  for (bake::cell_floor& floor : bake::floors_of_cells(boxes, is_over_floors(data.info))) {
    picture::floor_plan plan;
    plan.frame = frame;
    plan.bare = true;
    for (const std::uint32_t cell : floor.cells)
      plan.areas.push_back({.where = rectangle_in_plan(data.cells[cell]),
                            .ground = static_cast<float>(static_cast<double>(data.cells[cell].min[1]) - below),
                            .color = 0.0f});
    const picture::image_rgba ground = halved_to(picture::draw_floor_plan(world, plan), longest_plan);
    data.floors.push_back({.cells = std::move(floor.cells),
                           .lowest = floor.lowest - below,
                           .highest = floor.highest - below,
                           .ground = data_uri_of(ground)});
  }
}

ordered_json verified(const scene::scene& s, const scene::scene* cells_from, const pvs_file& file,
                      const report_request& request, progress_line& line) {
  // Bounds of other metrics need the options of the bake; `verify` takes them.
  if (file.metric() != bake::metric_names.front() || request.rays == std::uint64_t{0}) return nullptr;
  bake::verify_settings how;
  how.cells_from = cells_from;
  const double bound = file.requested_bound();
  how.rays = request.rays.value_or(std::max(how.rays, rays_for(bound)));
  const bake::verification v =
      bake::verify(s, file.bytes(), request.file.string(), how,
                   [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
  std::vector<named_miss> missing;
  for (const bake::missing_polygon& miss : v.missing) missing.push_back(name_miss(s, v, miss));
  return verify_json(v, missing, nullptr, {std::string(file.metric()), bound, how.seed});
}

}  // namespace

report_data collect_report(const scene::scene& s, const scene::scene* cells_from, const pvs_file& file,
                           const report_request& request, progress_line& line) {
  ordered_json verify, bake = request.bake;
  if (!request.verify_file.empty()) verify = read_verify_result(request.verify_file, file);
  if (!request.bake_file.empty()) bake = read_bake_result(request.bake_file, file);
  report_data data{.scene_path = request.scene.string(),
                   .file_path = request.file.string(),
                   .report_path = request.output.string(),
                   .info = file_info(file, request.file.string()),
                   .verify = std::move(verify),
                   .bake = std::move(bake),
                   .cells = cells_of(file),
                   .floors = {},
                   .frame = {},
                   .views = {},
                   .views_tried = 0,
                   .views_note = {},
                   .unseen = bake::find_unseen(s, file.bytes(), request.file.string()),
                   .raised = {}};
  if (request.summary != nullptr) add_seconds(request.summary->times, data.cells);
  if (data.verify.is_null()) data.verify = verified(s, cells_from, file, request, line);
  std::vector<std::uint32_t> all(data.cells.size());
  std::iota(all.begin(), all.end(), 0u);
  const std::vector<bake::cell_view> views =
      bake::find_cell_views(s, cells_from, file.bytes(), request.file.string(), all, view_seed);
  data.raised = find_raised_cells(data.cells, views);
  scene::world_geometry world = scene::flatten(s, file.animated());
  bake::apply_stored_overrides(file.content().settings(), world);
  if (cells_from != nullptr) {
    data.views_note = "There are no pictures: they are of one scene, and what occludes is in the other one too.";
    const scene::world_geometry around = scene::flatten(*cells_from, file.animated());
    add_floors(around, data);
  } else {
    draw_views(s, world, file, views, data);
    add_floors(world, data);
  }
  return data;
}

}  // namespace sightcell::cli
