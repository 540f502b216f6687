#pragma once
// What the author of a cells file knows better than any ray: polygons that are in every set, in none, or in the set of
// one cell besides what is seen from there.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct overrides {
  using ranges = std::vector<scene::polygon_range>;  // ascending, with gaps between them

  ranges always, never;
  std::vector<ranges> add;  // by the cell's number in the file; shorter where the last cells add nothing

  bool empty() const { return always.empty() && never.empty() && add.empty(); }
};

// Of a cells file: "always" and "never" beside "cells", "add" in a cell, each {"nodes": ["name"], "polygons": [12,
// [100, 199]]}. Throws sightcell::error (bad_input) that names the file and what is wrong.
overrides read_overrides(const std::filesystem::path& path, const scene::scene& s);
// The same from text; subject names it in errors.
overrides parse_overrides(std::string_view text, const std::string& subject, const scene::scene& s);

// never: absent, in no set, and hides nothing; wins over always. always: in every set; what is absent stays out. Where
// there is a never the bounds are those of what is left.
void apply(const overrides& given, scene::world_geometry& geometry);

// Polygons of the cell with this number join its set (ascending ids), but for those of never.
void add_polygons(const overrides& given, std::uint32_t cell, std::vector<std::uint32_t>& set);

// Names them in a checkpoint's key; 0 where there are none.
std::uint64_t hash_of(const overrides& given);

// The settings text of a file with its always and never, which a check has to know; and them from such a text. What is
// malformed or out of range there is passed over.
std::string with_overrides(const std::string& settings, const overrides& given);
overrides stored_overrides(std::string_view settings, std::uint32_t polygon_count);

}  // namespace sightcell::bake
