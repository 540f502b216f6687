#include "job/traced_scene.h"

namespace sightcell::bake {

traced_scene::traced_scene(const scene::world_geometry& geometry, const settings& how, const partners_before* before)
    : rays(geometry, how.all_double_sided) {
  if (needs_neighbors(how)) neighbors.emplace(rays, before);
}

}  // namespace sightcell::bake
