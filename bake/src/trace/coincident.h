#pragma once
// Finds polygons that overlap in the same place without being exact duplicates: decals, walls modeled twice, carpets
// (docs/method/visibility-rules.md, rule 2). Where one is visible, verified dilation casts rays at the others.
#include <cstdint>
#include <span>
#include <vector>

#include "trace/ray_scene.h"

namespace sightcell::bake {

class coincident_partners {
 public:
  // Finds the coincident partners of all polygons of a scene.
  // Each polygon is probed at its centroid and near its three corners, along its normal in both directions. The reach
  // is that of rule 2 at a distance of the diagonal of the scene's box, clamped to 2 mm .. 1 cm. A polygon that a probe
  // meets and that can face the same viewpoint is a partner, and the relation is symmetric. At shorter viewing
  // distances the reach of rule 2 is smaller; there the dilation ray decides. Overlaps that no probe of either polygon
  // meets are not found.
  // Threads: runs in the TBB arena of the calling thread. The result does not depend on the number of threads.
  explicit coincident_partners(const ray_scene& rays);

  // Returns the partners of a polygon, ascending; empty if it has none. Cost: O(log polygon_count()).
  std::span<const std::uint32_t> of(std::uint32_t polygon) const;

  std::uint32_t polygon_count() const {
    return static_cast<std::uint32_t>(polygons_.size());
  }  // Returns the number of polygons that have partners.

 private:
  std::vector<std::uint32_t> polygons_;  // with partners, ascending
  std::vector<std::uint32_t> starts_;    // index into partners_ of the first partner of each, then the end
  std::vector<std::uint32_t> partners_;
};

}  // namespace sightcell::bake
