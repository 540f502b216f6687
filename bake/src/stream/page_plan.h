#pragma once
// Which page has which polygons.
#include <cstdint>
#include <functional>
#include <vector>

#include "sightcell/scene/stream_pages.h"
#include "stream/polygon_numbers.h"
#include "stream/sketches.h"

namespace sightcell::bake {

inline constexpr std::uint32_t no_page = 0xFFFFFFFFu;

struct page_plan {
  std::vector<std::vector<scene::page_part>> pages;  // parts of a page ascend by geometry
  std::vector<std::uint32_t> page_of;                // by polygon number; no_page: not drawn
  std::vector<std::uint32_t> always;                 // pages that every cell needs, ascending
};

// Returns whether a client shows a draw wherever the camera is: the host moves it, or it has the mark `always`.
bool is_in_every_cell(const scene::draw& d);

// Divides the polygons of each geometry into chunks of polygons that are visible from the same cells at about the same
// size, and similar chunks of all geometries into pages. Polygons of draws that are in every cell, and polygons that
// are visible from no cell, have pages of their own.
// page_bytes: size of a page, in the mean of many.
// on_progress: receives the number of geometries that are done.
// Cost: O(polygons log polygons), on all threads. The result does not depend on their number.
page_plan plan_pages(const scene::gltf_pager& pager, const polygon_numbers& numbers, const sketch_table& seen,
                     std::uint32_t page_bytes, const std::function<void(std::uint64_t)>& on_progress);

}  // namespace sightcell::bake
