#include "sampler/gvs.h"

#include <glm/geometric.hpp>
#include <vector>

#include "sampler/border_sampling.h"
#include "sampler/guided_search.h"
#include "sampler/reverse_sampling.h"

namespace sightcell::bake {
namespace {

// Border and reverse sampling of one polygon.
class gvs_step {
 public:
  gvs_step(const settings& how, const ray_scene& rays, const box& cell) : how_(how), rays_(rays), cell_(cell) {}

  void follow(const seed_ray& from, noting_rays& caster, followed& out) const {
    const auto offset = static_cast<float>(how_.border_offset);
    std::vector<glm::vec3> eyes;
    const auto cast = [&](const glm::vec3& point) {
      const glm::vec3 toward = point - from.eye;
      const float reach = glm::length(toward);
      if (!(reach > 0.0f)) return border_hit{point, no_polygon, reach};
      ++out.rays;
      const sight& seen = caster.cast(from.eye, toward / reach, true, out.found);
      const border_hit hit{point, seen.front, seen.distance};
      if (!is_blocked_before(hit.distance, reach)) return hit;
      eyes.clear();
      add_reverse_eyes(corners_of(rays_.geometry(), hit.front), from.eye, from.point, point, offset, cell_, eyes);
      for (const glm::vec3& eye : eyes) {
        const glm::vec3 back = point - eye;
        const float length = glm::length(back);
        if (!(length > 0.0f)) continue;
        ++out.rays;
        caster.cast(eye, back / length, false, out.found);
      }
      return hit;
    };
    sample_border(enlarged(corners_of(rays_.geometry(), from.polygon), from.eye, offset), how_.border_depth, cast);
  }

  std::uint64_t most_rays() const { return 3 * most_border_rays(how_.border_depth); }

 private:
  const settings& how_;
  const ray_scene& rays_;
  const box& cell_;
};

}  // namespace

sampling_effort gvs::sample(const sampled_cell& cell, cell_set& set) const {
  guided_search search(how_, world_, cell, set);
  const gvs_step step(how_, world_.rays, cell.grown);
  while (!search.over()) {
    const std::uint32_t before = set.size();
    search.look_at_random();
    search.follow_all(step.most_rays(), [&](const seed_ray& from, noting_rays& caster, followed& out) {
      step.follow(from, caster, out);
    });
    if (set.size() - before < how_.fewest_new) break;
  }
  return {.rays = search.spent()};
}

}  // namespace sightcell::bake
