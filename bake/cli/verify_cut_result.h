#pragma once
// verify --cut: what levels of detail in clusters miss, as people and tools read it.
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "progress_line.h"
#include "sightcell/bake/verify_cut.h"

namespace sightcell::scene {
struct scene;
}

namespace sightcell::cli {

// One line for each number of pixels, and the clusters that the most rays miss. bound: that decides.
void report_cuts(const std::vector<bake::cut_verification>& cuts, const scene::scene& s, double bound,
                 progress_line& line);

// All of it.
nlohmann::ordered_json cuts_json(const std::vector<bake::cut_verification>& cuts, const scene::scene& s, double bound);

}  // namespace sightcell::cli
