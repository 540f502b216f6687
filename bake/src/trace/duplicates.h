#pragma once
// Polygons in exactly the same place (docs/method/visibility-rules.md, rule 2).
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Classes of exact duplicates. Polygons are in one class if they have the same three corners (bitwise, except that -0
// equals +0, in any rotation), the same kind and the same facing. Double-sided polygons match with either winding.
// Absent polygons are in no class.
// The kind is what decides how a polygon is visible and what it occludes. polygon_kind::always does not count: a
// polygon that is in every set may share a class with one that is not.
// Memory: 8 bytes per polygon of the scene during construction, then 12 bytes per polygon that is in a class.
class duplicate_classes {
 public:
  duplicate_classes() = default;  // no polygon has a duplicate
  // all_double_sided: the sidedness of materials is ignored.
  duplicate_classes(const scene::world_geometry& geometry, bool all_double_sided);

  // Returns all members of the polygon's class, the polygon included, ascending; empty if it has no duplicate. Cost:
  // O(log polygon_count()).
  std::span<const std::uint32_t> class_of(std::uint32_t polygon) const;

  std::uint32_t polygon_count() const {
    return static_cast<std::uint32_t>(members_.size());
  }  // in all classes together
  std::uint32_t class_count() const { return static_cast<std::uint32_t>(begins_.size()) - 1; }

 private:
  std::vector<std::uint32_t> members_;  // class by class
  std::vector<std::uint32_t> begins_{0};  // index into members_ of the first member of each class, then the end
  std::vector<std::uint32_t> sorted_;   // members_, ascending
  std::vector<std::uint32_t> numbers_;  // the class number of each polygon in sorted_
};

}  // namespace sightcell::bake
