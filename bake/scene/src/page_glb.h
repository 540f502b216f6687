#pragma once
// The .glb of a page (docs/streaming.md, "Pages").
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rounded_geometry.h"
#include "sightcell/scene/stream_pages.h"

namespace sightcell::scene {

// Returns the file. parts: one per geometry, ascending; polygons that are not drawn are left out.
std::vector<std::byte> page_glb(std::span<const rounded_geometry> geometries, std::span<const page_part> parts);

// Returns the bytes of the compressed streams of one part.
std::uint32_t stream_bytes(const rounded_geometry& g, const page_part& part);

}  // namespace sightcell::scene
