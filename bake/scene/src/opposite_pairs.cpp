#include "opposite_pairs.h"

#include <xxhash.h>

#include <algorithm>
#include <compare>
#include <vector>

#include "sightcell/scene/polygon_corners.h"

namespace sightcell::scene {
namespace {

// Sorting by hash groups polygons in the same place; equal hashes are ordered by the place itself.
struct candidate {
  std::uint64_t hash = 0;
  std::uint32_t polygon = 0;
};

std::vector<candidate> single_sided_masks(const world_geometry& geometry) {
  std::vector<candidate> found;
  for (std::uint32_t p = 0; p < geometry.kinds.size(); ++p) {
    const polygon_kind kind = geometry.kinds[p];
    if (kind.absent || kind.double_sided || kind.alpha != alpha_mode::mask) continue;
    const polygon_corners place = corners_of(geometry, p).sorted();
    found.push_back({XXH3_64bits(&place, sizeof place), p});
  }
  return found;
}

}  // namespace

void join_opposite_pairs(world_geometry& geometry) {
  std::vector<candidate> found = single_sided_masks(geometry);
  const auto place_of = [&](const candidate& c) { return corners_of(geometry, c.polygon).sorted(); };
  std::sort(found.begin(), found.end(), [&](const candidate& a, const candidate& b) {
    return a.hash != b.hash ? a.hash < b.hash : place_of(a) < place_of(b);
  });
  for (auto first = found.begin(); first != found.end();) {
    const auto end = std::find_if(first + 1, found.end(), [&](const candidate& c) {
      return c.hash != first->hash || place_of(c) != place_of(*first);
    });
    const polygon_corners one_way = corners_of(geometry, first->polygon).rotated();
    if (std::any_of(first + 1, end,
                    [&](const candidate& c) { return corners_of(geometry, c.polygon).rotated() != one_way; })) {
      for (auto c = first; c != end; ++c) geometry.kinds[c->polygon].double_sided = true;
    }
    first = end;
  }
}

}  // namespace sightcell::scene
