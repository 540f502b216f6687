#pragma once
// verify --levels: what levels of detail of objects miss, as people and tools read it.
#include <nlohmann/json_fwd.hpp>

#include "progress_line.h"
#include "sightcell/bake/verify_levels.h"

namespace sightcell::scene {
struct scene;
}

namespace sightcell::cli {

// The result, and what the most rays miss. bound: that decides.
void report_levels(const bake::level_verification& v, const scene::scene& s, double bound, progress_line& line);

// All of it.
nlohmann::ordered_json levels_json(const bake::level_verification& v, const scene::scene& s, double bound);

}  // namespace sightcell::cli
