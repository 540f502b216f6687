#pragma once
// Several cells in work at once.
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "cell_bake.h"
#include "cells/view_cell.h"

namespace sightcell::bake {

// How many cells are in work at once: one per thread where the source is shared, one where it is not. Every lane has a
// cell set, which is as large as the scene; where they would take more than a gibibyte together there are fewer lanes,
// and the other threads help inside of cells.
std::size_t lane_count(bool shared, int threads, std::size_t set_bytes);

// Told of a cell as it ends, by its place in the list; in_work: how many others lanes are busy with. False: no further
// one is begun.
using cell_ended = std::function<bool(std::uint32_t which, baked_cell& cell, std::size_t in_work)>;

// Bakes the cells named by wanted (places in cells) in that order, so many lanes at once, on the arena. All calls of
// ended come on the calling thread, one at a time, in the order in which cells end. The calling thread must not be
// inside of the arena.
//
// When ended answers false or throws, and when a cell throws, no further cell is begun; those in work come to their end
// and ended is called for them too. Then the first of what was thrown is thrown from here. With one lane all of it
// happens on the calling thread, as a source that is not shared demands.
void bake_cells(const cell_baker& baker, std::span<const view_cell> cells, std::span<const std::uint32_t> wanted,
                std::size_t lanes, tbb::task_arena& arena, const cell_ended& ended);

}  // namespace sightcell::bake
