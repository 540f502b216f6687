#pragma once
// Blended polygons from the farthest to the nearest: each shows what lies behind it.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "draw_lists.h"

namespace viewer {

// Polygons that are drawn with one state by one call, out of the list of everything in stored order.
struct blended_run {
  std::uint32_t group = 0;
  std::uint32_t list = 0;  // which of the lists they are from
  group_stretches stretches;
};

class blended_order {
 public:
  // groups: must outlive the object. stored_indices: into positions.
  blended_order(const draw_groups& groups, std::span<const sightcell_draw> draws, std::span<const glm::vec3> positions,
                std::span<const std::uint32_t> stored_indices);

  bool empty() const { return polygons_.empty(); }
  // Forgets what was added.
  void clear() { chosen_.clear(); }
  // Adds the blended polygons among the parts of a list.
  void add(std::span<const list_part> parts, std::uint32_t list);
  // Returns the runs of all that was added, valid until the next call. Equally far ones come in stored order.
  const std::vector<blended_run>& sorted(const glm::vec3& eye);

 private:
  struct polygon {
    std::uint32_t stored;
    std::uint32_t group;
    glm::vec3 center;
  };
  struct chosen {
    float distance;
    std::uint32_t polygon;  // in polygons_
    std::uint32_t list;
  };
  const draw_groups& groups_;
  std::vector<std::uint32_t> first_of_draw_;  // stored
  std::vector<polygon> polygons_;             // ascending
  std::vector<chosen> chosen_;
  std::vector<blended_run> runs_;
};

}  // namespace viewer
