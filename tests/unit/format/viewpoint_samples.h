#pragma once
// Regions of viewpoints for tests, made by the rules of SPEC.md alone.
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sample_contents.h"
#include "sightcell/format/viewpoint_table.h"

namespace sightcell::test {

// The bytes of a region. nodes: a digit for each node in preorder: 0 outside, 1 inside, 2 split, 3 not allowed.
std::vector<std::byte> packed_nodes(std::string_view nodes);

struct sample_region {
  std::vector<std::byte> bytes;  // empty: the whole box
  std::vector<format::region_part> parts;
};

// The whole box, a tree of a few levels, or one that is as deep as it may be. Equal seeds give equal regions.
sample_region make_region(std::uint32_t seed, const format::box& grown);

// Adds a record to each cell; cell i has make_region(seed + i, its grown box).
void add_viewpoints(sample_contents& contents, std::uint32_t seed);

// Gives each record of contents.viewpoints 0 to 8 eyes anywhere in the box of its cell. The first cell has the eyes at
// both ends of its box.
void add_eyes(sample_contents& contents, std::uint32_t seed);

}  // namespace sightcell::test
