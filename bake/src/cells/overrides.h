#pragma once
// Overrides of a cells file: polygons that are in every set, in none, or in the set of one cell in addition to those
// found visible.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct overrides {
  using ranges = std::vector<scene::polygon_range>;  // ascending, disjoint and not adjacent

  ranges always, never;
  std::vector<ranges> add;  // by cell number in the file; shorter if the last cells add nothing

  bool empty() const { return always.empty() && never.empty() && add.empty(); }
};

// Reads the overrides of a cells file: "always" and "never" beside "cells", "add" in a cell, each {"nodes": ["name"],
// "polygons": [12, [100, 199]]}.
// Throws sightcell::error (bad_input) with the file and what is wrong.
overrides read_overrides(const std::filesystem::path& path, const scene::scene& s);
// As read_overrides(), from a text.
// subject: names the text in errors.
overrides parse_overrides(std::string_view text, const std::string& subject, const scene::scene& s);

// Applies `always` and `never` to a scene. Polygons of `never` become absent: they are in no set and do not occlude.
// `never` takes precedence over `always`. Polygons of `always` are in every set, unless they are absent. If `never` is
// not empty, the bounds of the scene become those of the remaining polygons.
void apply(const overrides& given, scene::world_geometry& geometry);

// Adds the polygons that the overrides add to a cell to its set, except those of `never`.
// cell: its number in the cells file.
// set: ascending ids, before and after.
void add_polygons(const overrides& given, std::uint32_t cell, std::vector<std::uint32_t>& set);

// Returns a hash for the key of a checkpoint; 0 if there are no overrides.
std::uint64_t hash_of(const overrides& given);

// with_overrides() returns the settings text of a .pvs file with `always` and `never`, which `sightcell verify` needs.
// stored_overrides() reads them from such a text and ignores what is malformed or out of range.
std::string with_overrides(const std::string& settings, const overrides& given);
overrides stored_overrides(std::string_view settings, std::uint32_t polygon_count);

}  // namespace sightcell::bake
