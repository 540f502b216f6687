#pragma once
// Polygons that lie in exactly the same place (docs/method/visibility-rules.md, rule 2).
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Exact duplicates: polygons with the same three corners (the same bits but for -0 = +0, in any rotation), the same
// kind and the same facing are one class. Polygons that are seen from both sides have no facing: any winding. Absent
// polygons are in no class. The kind is what decides how a polygon is seen and what it hides: a polygon that is in
// every set anyway (polygon_kind::always) may be in one class with one that is not. Memory: while it is built 8 bytes
// per polygon; what stays is 12 bytes per polygon of a class.
class duplicate_classes {
 public:
  duplicate_classes(const scene::world_geometry& geometry, bool all_double_sided);

  // All members of the polygon's class, itself included, ascending; empty where it is alone. O(log polygon_count()).
  std::span<const std::uint32_t> class_of(std::uint32_t polygon) const;

  std::uint32_t polygon_count() const { return static_cast<std::uint32_t>(members_.size()); }  // in all classes
  std::uint32_t class_count() const { return static_cast<std::uint32_t>(begins_.size()) - 1; }

 private:
  std::vector<std::uint32_t> members_;  // class after class
  std::vector<std::uint32_t> begins_;   // of each class in members_, and the end of the last
  std::vector<std::uint32_t> sorted_;   // all members, ascending
  std::vector<std::uint32_t> numbers_;  // the class of each of sorted_
};

}  // namespace sightcell::bake
