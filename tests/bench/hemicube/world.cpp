#include "bench/hemicube/world.h"

#include <glm/geometric.hpp>

#include "sightcell/scene/error.h"
#include "source/gpu_source.h"
#ifdef SIGHTCELL_BENCH_CPU
#include "source/cpu_source.h"
#endif
#ifdef SIGHTCELL_BENCH_RAYS
#include "source/rays_source.h"
#endif

namespace sightcell::bench {

world::world(const std::string& path) {
  const scene::scene loaded = scene::load_gltf(path);
  name = loaded.name;
  geometry = scene::flatten(loaded);
  far_plane = glm::distance(geometry.min, geometry.max);
}

const std::vector<std::string>& source_names() {
  static const std::vector<std::string> names{
#ifdef SIGHTCELL_BENCH_CPU
      "cpu",
#endif
      "gpu",
#ifdef SIGHTCELL_BENCH_RAYS
      "rays",
#endif
  };
  return names;
}

named_source make_source(const std::string& name, const world& w, std::uint32_t resolution) {
  named_source made{name, nullptr, nullptr};
  if (name == "gpu") {
    made.context = std::make_unique<picture::gl_context>();
    made.source =
        bake::make_gpu_source(*made.context, w.geometry, {.resolution = resolution, .far_plane = w.far_plane});
  }
#ifdef SIGHTCELL_BENCH_CPU
  if (name == "cpu")
    made.source = bake::make_cpu_source(w.geometry, {.resolution = resolution, .far_plane = w.far_plane});
#endif
#ifdef SIGHTCELL_BENCH_RAYS
  if (name == "rays")
    made.source = bake::make_rays_source(w.geometry, {.resolution = resolution, .far_plane = w.far_plane});
#endif
  if (!made.source)
    throw error(error_kind::wrong_use, "bench.source", "the source '" + name + "'", "was not compiled in",
                "ask for others");
  return made;
}

}  // namespace sightcell::bench
