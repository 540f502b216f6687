#pragma once
// The difference of two sets in the rank space of the first. The counterpart for reading, rank_difference.h, defines
// it.
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

// Computes the lists that turn reference into set. Both are replaced. Allocates.
void make_rank_difference(std::span<const run> reference, std::span<const run> set, std::vector<run>& removed,
                          std::vector<run>& added);

}  // namespace sightcell::format
