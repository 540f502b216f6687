#include "sampler/gvs_plus_plus.h"

#include <glm/geometric.hpp>

#include "sampler/border_sampling.h"
#include "sampler/guided_search.h"
#include "sampler/reverse_sampling.h"

namespace sightcell::bake {
namespace {

// A cell is finished after this many iterations in a row that found too little.
constexpr int poor_iterations = 3;

class bulk_step {
 public:
  bulk_step(const settings& how, const ray_scene& rays, const box& cell) : how_(how), rays_(rays) {
    const std::vector<glm::vec3> points = edge_points(cell, how.border_samples);
    std::vector<std::uint8_t> free(points.size());
    rays.find_valid(points, how.player_radius, free);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (free[i]) eyes_.push_back(points[i]);
  }

  void follow(const seed_ray& from, noting_rays& caster, followed& out) const {
    std::vector<glm::vec3> hidden;  // discontinuities: border points that their ray did not reach
    const auto cast = [&](const glm::vec3& eye, const glm::vec3& point) {
      const glm::vec3 toward = point - eye;
      const float reach = glm::length(toward);
      if (!(reach > 0.0f)) return false;
      ++out.rays;
      return is_blocked_before(caster.cast(eye, toward / reach, true, out.found).distance, reach);
    };
    for (const glm::vec3& point : border_points(corners_of(rays_.geometry(), from.polygon), from.eye,
                                                static_cast<float>(how_.border_offset), how_.border_samples))
      if (cast(from.eye, point)) hidden.push_back(point);
    if (hidden.empty()) return;
    // Each eye is paired with one occluded border point; eyes that are neighbors on an edge get points far from each
    // other.
    std::size_t next = 0;
    for (const glm::vec3& eye : eyes_) {
      cast(eye, hidden[next % hidden.size()]);
      next += hidden.size() * 382 / 1000 + 1;  // the golden section
    }
  }

  std::uint64_t most_rays() const { return 9 + 15 * std::uint64_t{how_.border_samples}; }

 private:
  const settings& how_;
  const ray_scene& rays_;
  std::vector<glm::vec3> eyes_;  // valid viewpoints along the edges of the cell
};

}  // namespace

std::vector<glm::vec3> border_points(const triangle& corners, const glm::vec3& eye, float offset,
                                     std::uint32_t samples) {
  const border_polygon ring = enlarged(corners, eye, offset);
  std::vector<glm::vec3> points;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    points.push_back(ring[i]);
    if (i % 3 != 2) continue;  // the segments around a corner are short
    const glm::vec3& to = ring[(i + 1) % ring.size()];
    for (std::uint32_t k = 1; k <= samples; ++k)
      points.push_back(glm::mix(ring[i], to, static_cast<float>(k) / static_cast<float>(samples + 1)));
  }
  return points;
}

std::vector<glm::vec3> edge_points(const box& cell, std::uint32_t samples) {
  std::vector<glm::vec3> points;
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner)
      for (std::uint32_t k = 0; k < samples; ++k) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        glm::vec3 p;
        p[axis] =
            glm::mix(cell.min[axis], cell.max[axis], (static_cast<float>(k) + 0.5f) / static_cast<float>(samples));
        p[u] = (corner & 1 ? cell.max : cell.min)[u];
        p[v] = (corner & 2 ? cell.max : cell.min)[v];
        points.push_back(p);
      }
  return points;
}

sampling_effort gvs_plus_plus::sample(const sampled_cell& cell, cell_set& set) const {
  guided_search search(how_, world_, cell, set);
  const bulk_step step(how_, world_.rays, cell.grown);
  for (int poor = 0; poor < poor_iterations && !search.over();) {
    const std::uint32_t before = set.size();
    search.look_at_random();
    search.follow_all(step.most_rays(), [&](const seed_ray& from, noting_rays& caster, followed& out) {
      step.follow(from, caster, out);
    });
    poor = set.size() - before < how_.fewest_new ? poor + 1 : 0;
  }
  return {.rays = search.spent()};
}

}  // namespace sightcell::bake
