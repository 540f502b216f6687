#pragma once
// Finds polygons that overlap in the same place without being exact duplicates: decals, walls modeled twice, carpets
// (docs/method/visibility-rules.md, rule 2). Where one is visible, verified dilation casts rays at the others.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "trace/ray_scene.h"

namespace sightcell::bake {

// Two polygons, the smaller number first.
using polygon_pair = std::pair<std::uint32_t, std::uint32_t>;

// The partners in an earlier version of a scene, as far as polygons are the same in both. Numbers are those of now.
struct partners_before {
  float reach = 0.0f;                // of the probes then, meters
  std::vector<polygon_pair> pairs;   // both polygons are still there
  std::vector<std::uint32_t> added;  // ascending: polygons that were not there
};

class coincident_partners {
 public:
  coincident_partners() = default;  // of no polygons

  // Finds the coincident partners of all polygons of a scene.
  // Each polygon is probed at its centroid and near its three corners, along its normal in both directions. The reach
  // is that of rule 2 at a distance of the diagonal of the scene's box, clamped to 2 mm .. 1 cm. A polygon that a probe
  // meets and that can face the same viewpoint is a partner, and the relation is symmetric. At shorter viewing
  // distances the reach of rule 2 is smaller; there the dilation ray decides. Overlaps that no probe of either polygon
  // meets are not found.
  // before: null: all polygons are probed. Otherwise those that were added and those near them, with the same result.
  // Threads: runs in the TBB arena of the calling thread. The result does not depend on the number of threads.
  explicit coincident_partners(const ray_scene& rays, const partners_before* before = nullptr);

  // Returns the partners of a polygon, ascending; empty if it has none. Cost: O(log polygon_count()).
  std::span<const std::uint32_t> of(std::uint32_t polygon) const;

  // Returns the number of polygons that have partners.
  std::uint32_t polygon_count() const { return static_cast<std::uint32_t>(polygons_.size()); }
  // Returns all pairs, ascending.
  std::vector<polygon_pair> pairs() const;
  // Returns the reach of the probes in meters.
  float reach() const { return reach_; }

 private:
  float reach_ = 0.0f;
  std::vector<std::uint32_t> polygons_;  // with partners, ascending
  std::vector<std::uint32_t> starts_;    // index into partners_ of the first partner of each, then the end
  std::vector<std::uint32_t> partners_;
};

}  // namespace sightcell::bake
