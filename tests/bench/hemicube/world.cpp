#include "bench/hemicube/world.h"

#include <glm/geometric.hpp>

#include "sightcell/scene/error.h"
#include "source/cpu_source.h"
#include "source/gpu_source.h"
#include "source/rays_source.h"

namespace sightcell::bench {

world::world(const std::string& path) {
  const scene::scene loaded = scene::load_gltf(path);
  name = loaded.name;
  geometry = scene::flatten(loaded);
  far_plane = glm::distance(geometry.min, geometry.max);
}

const std::vector<std::string>& source_names() {
  static const std::vector<std::string> names{
      "cpu",
      "gpu",
      "rays",
  };
  return names;
}

named_source make_source(const std::string& name, const world& w, std::uint32_t resolution,
                         const std::string& culling) {
  named_source made{name, nullptr, nullptr};
  if (name == "gpu") {
    made.context = std::make_unique<picture::gl_context>();
    bake::gpu_source_options options{.resolution = resolution, .far_plane = w.far_plane};
    if (culling == "frustum") options.hide = bake::culling::frustum;
    if (culling == "occlusion") options.hide = bake::culling::occlusion;
    made.source = bake::make_gpu_source(*made.context, w.geometry, options);
  }
  if (name == "cpu")
    made.source = bake::make_cpu_source(w.geometry, {.resolution = resolution, .far_plane = w.far_plane});
  if (name == "rays") made.source = bake::make_rays_source(w.geometry, {resolution, w.far_plane, true});
  if (!made.source)
    throw error(error_kind::wrong_use, "bench.source", "the source '" + name + "'", "is not known",
                "ask for cpu, gpu or rays");
  return made;
}

}  // namespace sightcell::bench
