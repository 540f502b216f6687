#pragma once
// The part of a shard's file that describes the whole bake, so that shards can be merged without the scene.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cells/cell_blocks.h"
#include "file/pvs_output.h"

namespace sightcell::bake {

// What merge needs besides the records of cells.
struct bake_plan {
  pvs_frame frame;
  std::vector<std::uint32_t> block_of;  // per cell
  std::vector<std::string> block_names;
};

// Returns the plan of a bake.
bake_plan plan_of(pvs_frame frame, const cell_blocks& blocks);

// Returns the bytes of a plan.
std::string encode(const bake_plan& plan);
// Throws sightcell::error "shard.damaged" with the name of the file if the bytes are no plan.
bake_plan decode_plan(std::string_view bytes, const std::string& file);

}  // namespace sightcell::bake
