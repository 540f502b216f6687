#include "bench/hemicube/world.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "hemicube/cpu/cpu_source.h"
#include "hemicube/gpu/gpu_source.h"
#include "hemicube/rays/rays_source.h"
#include "sightcell/base/error.h"

namespace sightcell::bench {
namespace {

struct kernel_name {
  const char* name;
  bake::cpu_instructions instructions;
};

constexpr kernel_name kernels[] = {{"cpu-avx2", bake::cpu_instructions::avx2},
                                   {"cpu-sse4", bake::cpu_instructions::sse4},
                                   {"cpu-neon", bake::cpu_instructions::neon},
                                   {"cpu-portable", bake::cpu_instructions::portable}};

}  // namespace

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

std::vector<std::string> kernel_names() {
  std::vector<std::string> names;
  for (const kernel_name& known : kernels) names.emplace_back(known.name);
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
  for (const kernel_name& known : kernels) {
    const auto there = bake::available_instructions();
    if (name == known.name && std::find(there.begin(), there.end(), known.instructions) != there.end())
      made.source = bake::make_cpu_source(w.geometry, {resolution, w.far_plane, known.instructions});
  }
  if (name == "rays") made.source = bake::make_rays_source(w.geometry, {resolution, w.far_plane, true});
  if (!made.source)
    throw error(error_kind::wrong_use, "bench.source", "the source '" + name + "'", "does not exist here",
                "ask for cpu, gpu or rays");
  return made;
}

}  // namespace sightcell::bench
