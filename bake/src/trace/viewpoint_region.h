#pragma once
// The part of a box in which viewpoints are drawn: all of it, or the parts of a binary space partition in which valid
// viewpoints were found. With it a valid viewpoint costs about the same however small the valid part of a box is.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {

// A k-d tree over a box. Each split halves the longest side (of equal sides the first of x, y, z). Leaves are inside or
// outside the region. Immutable; may be read from several threads.
class viewpoint_region {
 public:
  // The whole box.
  viewpoint_region(const box& whole) : whole_(whole) {}  // implicit: a box is a region
  viewpoint_region(const glm::vec3& min, const glm::vec3& max) : whole_{min, max} {}

  // What a decision about a node of the tree can be.
  enum class kind : std::uint8_t { outside, inside, split };
  // Builds a region from the root down. decide: called in preorder with the box and the depth of a node, 0 for the
  // root. Nodes that cannot be split count as inside: see can_split().
  static viewpoint_region build(const box& whole, const std::function<kind(const box& node, int depth)>& decide);
  // The greatest depth of a leaf.
  static constexpr int deepest = 18;
  // Returns the axis along which a node is split, and the coordinate of the split plane.
  static int longest_axis(const box& node);
  static float middle_of(const box& node, int axis) { return 0.5f * (node.min[axis] + node.max[axis]); }
  // Returns whether a node may be split: it is not at the greatest depth, and the plane has a place between the two
  // sides in single precision.
  static bool can_split(const box& node, int depth);

  // Returns the region as bytes: the tree in preorder, two bits per node (0 outside, 1 inside, 2 split), from the
  // lowest bits of the first byte. Unused bits are 0. Empty: the whole box.
  std::vector<std::uint8_t> encode() const;
  // Returns the region with these bytes. Nothing if they are not what encode() returns for some region with a part
  // inside. The bytes may be arbitrary.
  static std::optional<viewpoint_region> decode(const box& whole, std::span<const std::uint8_t> bytes);

  const box& whole() const { return whole_; }
  bool is_whole() const { return nodes_.empty(); }
  // Returns the leaves inside the region, disjoint, in preorder; the box itself for the whole box.
  std::vector<box> parts() const;
  // Returns the leaves outside the region.
  std::vector<box> rest() const;
  // Returns the volume of the region as a share of the box, 0 .. 1. It is exact up to rounding.
  double share() const { return is_whole() ? 1.0 : share_; }
  // Returns whether a point of the box is in the region. Points of a split plane belong to the upper half.
  bool contains(const glm::vec3& point) const;
  // Returns a point that is uniform in the region. The region must not be empty: share() > 0.
  glm::vec3 draw(random_stream& random) const;
  // The same for the rest of the box; share() must be less than 1.
  glm::vec3 draw_outside(random_stream& random) const;

 private:
  struct leaf {
    box at;
    std::uint64_t end = 0;  // volume of this leaf and those before it, in units of the smallest possible leaf
  };
  void add(kind what, const box& at, int depth);
  static glm::vec3 draw_of(const std::vector<leaf>& leaves, random_stream& random);

  box whole_;
  std::vector<kind> nodes_;  // in preorder; empty: the whole box
  std::vector<leaf> inside_, outside_;
  double share_ = 0.0;
};

}  // namespace sightcell::bake
