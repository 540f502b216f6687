#pragma once
// Where a camera can move: at a distance from all surfaces.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/scene/scene.h"

namespace gpu_driven {

class clearance {
 public:
  // world: must outlive the object.
  // radius: meters that a camera keeps from surfaces: sightcell_info.player_radius.
  clearance(const sightcell::scene::world_geometry& world, float radius);

  // Returns whether a camera can go straight from one point to another. A camera that begins outside of solids stays
  // outside, because it passes no surface.
  bool is_clear(const glm::vec3& from, const glm::vec3& to) const;

 private:
  struct block {  // polygons that follow each other
    glm::vec3 min, max;
    std::uint32_t first = 0, count = 0;
  };
  bool is_clear_at(const glm::vec3& at, const std::vector<std::uint32_t>& near_blocks) const;

  const sightcell::scene::world_geometry& world_;
  float radius_;
  std::vector<block> blocks_;
};

}  // namespace gpu_driven
