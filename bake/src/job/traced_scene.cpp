#include "job/traced_scene.h"

#include <tbb/parallel_invoke.h>

namespace sightcell::bake {

traced_scene::traced_scene(const scene::world_geometry& geometry, const settings& how, const partners_before* before,
                           const stop_request* stop)
    : rays(geometry, how.all_double_sided, stop) {
  tbb::parallel_invoke(
      [&] {
        if (needs_neighbors(how)) neighbors.emplace(rays, before);
      },
      [&] { duplicates = duplicate_classes(geometry, how.all_double_sided); });
}

}  // namespace sightcell::bake
