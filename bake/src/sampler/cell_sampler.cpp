#include "sampler/cell_sampler.h"

#include "sampler/agvs.h"
#include "sampler/color_weight.h"
#include "sampler/face_sampling.h"
#include "sampler/guided.h"
#include "sampler/gvs.h"
#include "sampler/gvs_plus_plus.h"
#include "sampler/nir04.h"
#include "search/gap_filter.h"
#include "search/hemicubes.h"

namespace sightcell::bake {
namespace {

// All samplers with hemicubes: full cubes at interior points first, then the faces.
class hemicube_sampler final : public cell_sampler {
 public:
  hemicube_sampler(const settings& how, const sampler_world& world) : how_(how), world_(world) {}

  bool uses_device() const override { return world_.source.device_seconds().has_value(); }

  sampling_effort sample(const sampled_cell& cell, cell_set& set) const override {
    gap_filter without_leaks(world_.source, world_.rays, set, how_.smallest_gap);
    const hemicube_plan plan{.samples = how_.samples,
                             .seed = how_.seed,
                             .place = cell.place,
                             .geometry_inside = cell.geometry_inside,
                             .interior_share = how_.interior_share,
                             .jitter = how_.jitter,
                             .limit = cell.limit};
    const auto is_valid = [&](const glm::vec3& eye) { return world_.rays.is_valid(eye, how_.player_radius); };
    hemicubes taken(plan, without_leaks, set);
    taken.take_interior(cell.free);
    if (how_.sampler == "nir04")
      sample_nir04({how_.difference, how_.part_polygons}, cell.grown, is_valid, taken);
    else
      sample_faces({.sampler = how_.sampler, .reliability = how_.reliability, .start_grid = how_.start_grid}, plan,
                   cell.grown, is_valid, taken, weight_with(without_leaks, set));
    return {.samples = taken.taken()};
  }

 private:
  // C is 1 where nothing is new, so that depth still has an effect when the set is nearly complete
  // (docs/method/samplers.md).
  importance_weight weight_with(hemicube_source& source, const cell_set& set) const {
    if (how_.sampler != "importance-depth-color") return nullptr;
    return [&](const pose& where, const hemicube_view& view) {
      return 1.0 + color_difference(where, view, source, world_.rays, *world_.colors, set);
    };
  }

  const settings& how_;
  const sampler_world world_;
};

}  // namespace

std::unique_ptr<cell_sampler> make_cell_sampler(const settings& how, const sampler_world& world) {
  if (how.sampler == "guided") return std::make_unique<guided>(how, world);
  if (how.sampler == "agvs") return std::make_unique<agvs>(how, world);
  if (how.sampler == "gvs") return std::make_unique<gvs>(how, world);
  if (how.sampler == "gvs++") return std::make_unique<gvs_plus_plus>(how, world);
  return std::make_unique<hemicube_sampler>(how, world);
}

}  // namespace sightcell::bake
