#pragma once
// Writes the JSON of a packed file.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "carried_materials.h"
#include "lod_levels.h"
#include "packed_vertices.h"
#include "sightcell/scene/pack.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Offsets in the single buffer of a packed file: vertices from 0 on, then indices, then images.
struct packed_places {
  std::uint64_t indices = 0;
  std::vector<std::uint64_t> images;  // in the order of carried_materials
  std::uint64_t bytes = 0;
};

// Returns the offsets of a packed file.
packed_places places_of(const scene& s, const packed_vertices& vertices, const carried_materials& materials);

// Returns the JSON of a packed file.
// switches: where levels of detail begin, by object.
nlohmann::json packed_document(const scene& s, const packed_order& order, const packed_vertices& vertices,
                               const carried_materials& materials, const packed_places& places,
                               const std::vector<object_switches>& switches);

}  // namespace sightcell::scene
