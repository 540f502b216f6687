#pragma once
// Coarser levels of detail, which hosts draw in place of what was found visible.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Adds all polygons of the coarser levels of detail of each object of which the set has a polygon of the finest level.
// set: ascending, before and after.
inline void add_coarser_levels(const std::vector<scene::lod_object>& objects, std::vector<std::uint32_t>& set) {
  const std::size_t seen = set.size();
  const auto any_in = [&](const scene::polygon_range& range) {
    const auto end = set.begin() + static_cast<std::ptrdiff_t>(seen);
    const auto first = std::lower_bound(set.begin(), end, range.first);
    return first != end && *first - range.first < range.count;
  };
  for (const scene::lod_object& object : objects) {
    if (std::none_of(object.finest.begin(), object.finest.end(), any_in)) continue;
    for (const scene::polygon_range& range : object.coarser)
      for (std::uint32_t i = 0; i < range.count; ++i) set.push_back(range.first + i);
  }
  std::sort(set.begin(), set.end());
  set.erase(std::unique(set.begin(), set.end()), set.end());
}

}  // namespace sightcell::bake
