#pragma once
// How large the file of a bake is, from trial cells.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "job/bake_context.h"

namespace sightcell::bake {

// Returns the cells to try: the middles of `count` equal parts of the list, in an order whose beginnings are spread
// over all of it, because trials may end early.
// count: at least 1, at most `cells`.
std::vector<std::uint32_t> choose_trials(std::size_t cells, std::size_t count);

// Returns the estimated bytes of the file with all cells. The trials are put in order and encoded as a file, whose size
// is scaled up: by less than the number of cells, because a cell adds less the more cells the file has.
// records: of trial cells that are spread over the list, as the file has them (cell_baker::finished); in any order.
// Returns 0 if none of the cells is stored.
// Cost: that of writing a file of these cells; it stays in memory. Threads: works on the calling thread's arena.
double estimate_file_bytes(const bake_context& context, std::vector<stage_record> records);

}  // namespace sightcell::bake
