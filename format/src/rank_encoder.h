#pragma once
// The difference of two sets in the rank space of the first. rank_difference.h is the way back and says what that is.
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

// The lists that make set of reference. Both replaced. Allocates.
void make_rank_difference(std::span<const run> reference, std::span<const run> set, std::vector<run>& removed,
                          std::vector<run>& added);

}  // namespace sightcell::format
