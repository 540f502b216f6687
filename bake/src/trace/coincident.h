#pragma once
// Which polygons lie on top of each other without being the same: decals, walls modeled twice, carpets (rule 2 of
// seeing). Where one is seen, rays are aimed at the others.
#include <cstdint>
#include <span>
#include <vector>

#include "trace/ray_scene.h"

namespace sightcell::bake {

class coincident_partners {
 public:
  // Probes every polygon at its middle and near its corners, up and down by rule 2's reach over the diagonal of the
  // scene's box, 2 mm to 1 cm: what lies there and can face the same eye is its partner, and it is theirs. Nearer by,
  // the ray that is aimed decides. Overlaps that none of the probes of either polygon meet are not found. Runs on the
  // calling thread's TBB arena; does not depend on the number of threads.
  explicit coincident_partners(const ray_scene& rays);

  // Ascending; empty where nothing lies on the polygon. O(log polygon_count()).
  std::span<const std::uint32_t> of(std::uint32_t polygon) const;

  std::uint32_t polygon_count() const { return static_cast<std::uint32_t>(polygons_.size()); }  // that have partners

 private:
  std::vector<std::uint32_t> polygons_;  // those that have partners, ascending
  std::vector<std::uint32_t> starts_;    // of each in partners_, and the end of the last
  std::vector<std::uint32_t> partners_;
};

}  // namespace sightcell::bake
