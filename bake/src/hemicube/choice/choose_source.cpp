#include "hemicube/choice/choose_source.h"

#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "hemicube/cpu/cpu_source.h"
#include "hemicube/gpu/gpu_source.h"
#include "hemicube/rays/rays_source.h"
#include "sightcell/bake/sampler_options.h"

namespace sightcell::bake {
namespace {

// The source of samplers that use no hemicubes.
class no_source final : public hemicube_source {
 public:
  using hemicube_source::render;
  void render(std::span<const pose>, std::span<hemicube_view>) override { fail(); }
  void render_image(const pose&, hemicube_image&) override { fail(); }
  bool shared() const override { return true; }
  std::uint32_t resolution() const override { return 0; }
  std::string device() const override { return "rays alone"; }

 private:
  [[noreturn]] static void fail() { throw std::logic_error("this sampler takes no hemicubes"); }
};

void resolve(const settings& how, chosen_source& chosen) {
  chosen.name = how.source;
  if (how.source == "gpu") chosen.context = std::make_unique<picture::gl_context>();
  if (how.source != "auto") return;
  chosen.context = picture::gl_context::on_hardware();
  chosen.name = chosen.context ? "gpu" : "cpu";
  chosen.because = chosen.context ? "a hardware GPU was found" : "no hardware GPU was found";
}

}  // namespace

chosen_source choose_source(const settings& how, const scene::world_geometry& geometry, const ray_scene& rays) {
  chosen_source chosen;
  if (!takes_hemicubes(how.sampler)) {
    chosen.name = "none";
    chosen.source = std::make_unique<no_source>();
    return chosen;
  }
  resolve(how, chosen);
  // The far plane of the importance is the diagonal of the scene's box.
  const float diagonal = glm::distance(geometry.min, geometry.max);
  if (chosen.name == "rays") {
    chosen.source = make_rays_source(rays, {.resolution = how.resolution, .far_plane = diagonal});
    return chosen;
  }
  const scene::world_geometry* drawn = &geometry;
  if (how.all_double_sided) {
    chosen.both_sides = std::make_unique<scene::world_geometry>(geometry);
    for (scene::polygon_kind& kind : chosen.both_sides->kinds) kind.double_sided = true;
    drawn = chosen.both_sides.get();
  }
  if (chosen.name == "gpu")
    chosen.source = make_gpu_source(*chosen.context, *drawn, {.resolution = how.resolution, .far_plane = diagonal});
  else
    chosen.source = make_cpu_source(*drawn, {.resolution = how.resolution, .far_plane = diagonal});
  return chosen;
}

}  // namespace sightcell::bake
