#include "job/bake_device.h"

namespace sightcell::bake {

bake_device::bake_device(const scene::scene& s, const settings& how, const scene::world_geometry& geometry,
                         const traced_scene& traced)
    : chosen(choose_source(how, geometry, traced.rays)) {
  const bool bounds = how.max_pixel_error > 0.0;
  const bool by_color = bounds && how.metric.kind == metric_kind::color;
  if (how.sampler == "importance-depth-color" || by_color) colors.emplace(s, geometry);
  if (bounds) metric = error_metric(how.metric, traced.rays, colors_or_null());
}

}  // namespace sightcell::bake
