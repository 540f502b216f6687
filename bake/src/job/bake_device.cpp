#include "job/bake_device.h"

namespace sightcell::bake {

bake_device::bake_device(const scene::scene& s, const settings& how, const scene::world_geometry& geometry,
                         const traced_scene& traced, const bake_cells& cells)
    : chosen(choose_source(how, geometry, traced.rays)) {
  const bool bounds = how.max_pixel_error > 0.0;
  const bool by_color = bounds && how.metric.kind == metric_kind::color;
  if (how.sampler == "importance-depth-color" || by_color) colors.emplace(s, geometry);
  const surface_colors* const colors_or_null = colors ? &*colors : nullptr;
  if (bounds) metric = error_metric(how.metric, traced.rays, colors_or_null);
  sampler = make_cell_sampler(
      how, {traced.rays, *chosen.source, colors_or_null, cells.list.cells, traced.neighbors_or_null()});
}

}  // namespace sightcell::bake
