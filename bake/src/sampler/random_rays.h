#pragma once
// Random rays out of a cell, for samplers that use rays.
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

// Draws rays in groups with random numbers of their own, so that threads can draw them in any order. All origins are
// valid viewpoints. Most rays leave the boundary of the grown box: the origin is uniform on its surface, and the
// density of the direction is the cosine over the outer half space. Straight lines that meet a convex body cross its
// surface with this distribution if all lines are equally likely (Santalo), so no sight line out of an empty cell is
// favored. In a cell with geometry inside, a share of the groups starts at valid viewpoints inside, uniform over the
// box and the sphere.
class random_rays {
 public:
  static constexpr std::size_t stretch = 512;

  struct plan {
    std::uint64_t seed = 0, place = 0;
    bool geometry_inside = false;
    double interior_share = 0.5;
    float player_radius = 0.05f;
  };

  // free: valid viewpoints of the box, at least one. References must outlive the object.
  random_rays(const ray_scene& rays, const plan& how, const box& grown, std::span<const glm::vec3> free);

  // Draws the rays of group `number` of a round; out is overwritten. May be called from several threads.
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
