#pragma once
// Random rays out of a cell, for samplers that look with rays.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sampler/cell_sampler.h"
#include "search/boundary_face.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct random_ray {
  glm::vec3 eye{0.0f}, direction{0.0f};
};

// Rays come in stretches, each with random numbers of its own, so that threads can draw them in any order. All eyes are
// free points. Most rays leave the boundary of the grown box: the place is uniform on its surface, and the direction
// has the density of the cosine over the outer half space. That is how the straight lines that meet a convex body cross
// its surface when all lines are as likely (Santalo), so no sight line out of an empty cell is favored. In a cell with
// geometry inside, a share of the stretches starts at free points of the inside, uniform over the box and the sphere.
class random_rays {
 public:
  static constexpr std::size_t stretch = 512;

  struct plan {
    std::uint64_t seed = 0, place = 0;
    bool geometry_inside = false;
    double interior_share = 0.5;
    float player_radius = 0.05f;
  };

  // References must outlive the object. free: free points of the box, one at least.
  random_rays(const ray_scene& rays, const plan& how, const box& grown, std::span<const glm::vec3> free);

  // The rays of stretch number of a round; out is overwritten. May be called from several threads.
  void draw(std::uint64_t round, std::uint64_t number, std::vector<random_ray>& out) const;

 private:
  struct start {
    glm::vec3 eye{0.0f}, outward{0.0f};  // zero: all directions
  };
  std::vector<start> on_boundary(random_stream& random) const;
  std::vector<start> inside(random_stream& random) const;

  const ray_scene& rays_;
  const plan how_;
  const box grown_;
  const std::array<boundary_face, 6> faces_;
  std::span<const glm::vec3> free_;
};

}  // namespace sightcell::bake
