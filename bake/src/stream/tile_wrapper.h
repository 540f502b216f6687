#pragma once
// The glTF file of a tile: the draws of the geometries of one page (docs/streaming.md, "3D Tiles").
#include <cstddef>
#include <span>
#include <string>

#include "sightcell/scene/stream_pages.h"
#include "stream/shown_draws.h"
#include "stream/tile_materials.h"

namespace sightcell::bake {

// Returns the JSON text, whose buffer is the file of the page. Empty if no draw shows any of it. The same page gives
// the same bytes. page: the bytes of the page. uri: of the page, as the text names it.
std::string tile_wrapper(std::span<const std::byte> page, const std::string& uri, const scene::gltf_pager& pager,
                         const shown_draws& shown, const tile_materials& materials);

}  // namespace sightcell::bake
