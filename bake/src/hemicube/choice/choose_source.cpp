#include "hemicube/choice/choose_source.h"

#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "hemicube/cpu/cpu_source.h"
#include "hemicube/gpu/gpu_source.h"
#include "hemicube/rays/rays_source.h"
#include "hemicube/source_on_thread.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/picture/gl_context.h"

namespace sightcell::bake {
namespace {

// The source of samplers that use no hemicubes.
class no_source final : public hemicube_source {
 public:
  using hemicube_source::render;
  void render(std::span<const pose>, std::span<hemicube_view>) override { fail(); }
  void render_image(const pose&, hemicube_image&) override { fail(); }
  std::uint32_t resolution() const override { return 0; }
  std::string device() const override { return "rays alone"; }

 private:
  [[noreturn]] static void fail() { throw std::logic_error("this sampler takes no hemicubes"); }
};

// Returns the context of the source gpu, which is current on the calling thread.
std::unique_ptr<picture::gl_context> resolve(const settings& how, chosen_source& chosen) {
  chosen.name = how.source;
  if (how.source == "gpu") return std::make_unique<picture::gl_context>();
  if (how.source != "auto") return nullptr;
  auto context = picture::gl_context::on_hardware();
  chosen.name = context ? "gpu" : "cpu";
  chosen.because = context ? "a hardware GPU was found" : "no hardware GPU was found";
  return context;
}

std::unique_ptr<hemicube_source> gpu_source_for_all(std::shared_ptr<picture::gl_context> context,
                                                    const scene::world_geometry& drawn,
                                                    const gpu_source_options& options) {
  context->release();
  return make_source_on_thread([context = std::move(context), &drawn, options] {
    context->make_current();
    return make_gpu_source(*context, drawn, options);
  });
}

}  // namespace

chosen_source choose_source(const settings& how, const scene::world_geometry& geometry, const ray_scene& rays) {
  chosen_source chosen;
  if (!takes_hemicubes(how.sampler)) {
    chosen.name = "none";
    chosen.source = std::make_unique<no_source>();
    return chosen;
  }
  auto context = resolve(how, chosen);
  // The far plane of the importance is the diagonal of the scene's box.
  const float diagonal = glm::distance(geometry.min, geometry.max);
  if (chosen.name == "rays") {
    chosen.source = make_rays_source(
        rays, {.resolution = how.resolution, .far_plane = diagonal, .importance = uses_importance(how.sampler)});
    return chosen;
  }
  const scene::world_geometry* drawn = &geometry;
  if (how.all_double_sided) {
    chosen.both_sides = std::make_unique<scene::world_geometry>(geometry);
    for (scene::polygon_kind& kind : chosen.both_sides->kinds) kind.double_sided = true;
    drawn = chosen.both_sides.get();
  }
  if (chosen.name == "gpu")
    chosen.source =
        gpu_source_for_all(std::move(context), *drawn, {.resolution = how.resolution, .far_plane = diagonal});
  else
    // Most cells that start from what they had take no hemicubes.
    chosen.source = make_cpu_source(*drawn, {.resolution = how.resolution,
                                             .far_plane = diagonal,
                                             .importance = uses_importance(how.sampler),
                                             .when_needed = how.keep_found && !how.since.empty()});
  return chosen;
}

}  // namespace sightcell::bake
