#pragma once
// The polygons found for one cell, with their witnesses, while all cells are sampled together: a flat hash table.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "trace/ray_scene.h"

namespace sightcell::bake {

// The polygons of one cell.
class seen_pairs {
 public:
  struct pair {
    std::uint32_t polygon = no_polygon;
    glm::vec3 eye{0.0f};
  };

  bool contains(std::uint32_t polygon) const { return !keys_.empty() && keys_[slot_of(polygon)] == polygon; }
  // Returns false if the polygon was there.
  bool add(std::uint32_t polygon, const glm::vec3& eye) {
    if (2 * (pairs_.size() + 1) > keys_.size()) grow();
    std::uint32_t& key = keys_[slot_of(polygon)];
    if (key == polygon) return false;
    key = polygon;
    pairs_.push_back({polygon, eye});
    return true;
  }
  // In the order in which they joined.
  const std::vector<pair>& all() const { return pairs_; }

 private:
  // Returns the slot of the polygon, or the one where it would be added.
  std::size_t slot_of(std::uint32_t polygon) const {
    const std::size_t mask = keys_.size() - 1;
    std::size_t slot = (std::uint64_t{polygon} * 0x9E3779B97F4A7C15ull >> 32) & mask;
    while (keys_[slot] != polygon && keys_[slot] != no_polygon) slot = (slot + 1) & mask;
    return slot;
  }
  void grow() {
    keys_.assign(keys_.empty() ? 64 : 2 * keys_.size(), no_polygon);
    for (const pair& p : pairs_) keys_[slot_of(p.polygon)] = p.polygon;
  }

  std::vector<std::uint32_t> keys_;  // size is a power of two; at most half of the slots are used
  std::vector<pair> pairs_;
};

}  // namespace sightcell::bake
