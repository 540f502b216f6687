#include "job/decide_cells.h"

#include <chrono>
#include <utility>

#include "job/merge_cells.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/stop_request.h"

namespace sightcell::bake {
namespace {

std::uint64_t merge(cell_list& list, const settings& how, const merge_tools& tools, const callbacks& events) {
  if (events.on_phase) events.on_phase(bake_phase::merging_cells);
  constexpr std::chrono::milliseconds pause{200};
  const auto began = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point reported{};
  return merge_cells(list, how, tools, [&](double share) {
    const auto now = std::chrono::steady_clock::now();
    if (!events.on_progress || now - reported < pause) return;
    reported = now;
    progress report;
    report.phase = bake_phase::merging_cells;
    report.prepared = share;
    report.seconds = std::chrono::duration<double>(now - began).count();
    if (share > 0.0) report.seconds_left = report.seconds / share * (1.0 - share);
    if (!events.on_progress(report)) throw step_stopped();
  });
}

}  // namespace

std::optional<decided_cells> decided_from(std::string_view bytes, const std::string& inputs) {
  std::optional<decided_cells> cells = decode_cells(bytes);
  if (cells && cells->inputs != inputs) cells.reset();
  return cells;
}

std::string name_of(const bake_device& device) {
  return device.chosen.name + " " + device.source().device();
}

decided_cells decide_cells(cell_list list, const std::string& inputs, const settings& how, const traced_scene& traced,
                           const bake_device& device, std::uint32_t own_polygons, const callbacks& events,
                           std::uint64_t& cubes) {
  decided_cells cells{.inputs = inputs, .device = name_of(device), .list = std::move(list), .boxes = {}};
  if (how.volumes > 0.0) cells.boxes = cells.list.cells;
  cubes = 0;
  if (cells.list.can_merge && how.merge_cells > 0.0 && takes_hemicubes(how.sampler))
    cubes = merge(cells.list, how, {traced.rays, device.source(), own_polygons}, events);
  return cells;
}

}  // namespace sightcell::bake
