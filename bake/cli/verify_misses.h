#pragma once
// verify --from: what a host found missing, as people and tools read it.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "progress_line.h"
#include "sightcell/bake/misses.h"

namespace sightcell::scene {
struct scene;
}

namespace sightcell::cli {

// The first few that were reproduced, and how many of each kind there are. file: of the misses.
void report_misses(const bake::miss_check& found, const scene::scene& s, const std::string& file, progress_line& line);

// All of it.
nlohmann::ordered_json misses_json(const bake::miss_check& found, const scene::scene& s);

}  // namespace sightcell::cli
