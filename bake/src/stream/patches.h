#pragma once
// Patches: connected polygons of a geometry that are visible from nearly the same cells.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "stream/sketches.h"

namespace sightcell::bake {

// Joins polygons that share an edge and a quarter of the components of their sketches, the most similar ones first.
// What stays in one page has each vertex once. polygons: those to join. corners: three vertices per polygon of the
// geometry. seen: the sketch of a polygon. Returns the patches with their polygons, of the order of their first ones.
// Cost: O(n log n).
std::vector<std::vector<std::uint32_t>> patches_of(std::span<const std::uint32_t> polygons,
                                                   std::span<const std::uint32_t> corners,
                                                   const std::function<const sketch&(std::uint32_t)>& seen);

}  // namespace sightcell::bake
