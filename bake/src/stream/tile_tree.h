#pragma once
// The tileset.json over the tiles (docs/streaming.md, "3D Tiles").
#include <cstdint>
#include <span>
#include <string>

#include "stream/tile_shape.h"

namespace sightcell::bake {

struct listed_tile {
  std::uint32_t page = 0;
  std::string uri;  // of its file
  tile_shape shape;
};

// Returns the JSON text.
std::string tileset_json(std::span<const listed_tile> tiles);

}  // namespace sightcell::bake
