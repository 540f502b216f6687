#pragma once
// What `sightcell verify` prints, as JSON.
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sightcell/bake/verify.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

// A missing polygon with the names a person can look for.
struct named_miss {
  bake::missing_polygon miss;
  std::uint32_t draw = 0, node = 0;
  std::string node_name;
  double share = 0.0;  // of its cell's rays
};

// What a verification was asked for.
struct asked_of_verify {
  std::string metric;
  double bound = 0.0;
  std::uint64_t seed = 0;
};

// Returns a missing polygon of v with its names.
named_miss name_miss(const scene::scene& s, const bake::verification& v, const bake::missing_polygon& miss);

// Returns the cell with the largest error; where none has any, the one that was proved least. Null without cells.
const bake::cell_verification* worst_cell(const bake::verification& v);

// Returns an entry of "missing".
nlohmann::ordered_json miss_json(const named_miss& named);

// Returns the object that `verify --json` prints; docs/json-files.md has its keys.
nlohmann::ordered_json verify_json(const bake::verification& v, const std::vector<named_miss>& missing,
                                   const nlohmann::ordered_json& worst_view, const asked_of_verify& asked);

// Returns how many rays verify casts for a bound, if that is more than its default. Without a miss, 3 / bound rays
// prove a bound at 95 % confidence; these are some more, because a few misses are normal.
std::uint64_t rays_for(double bound);

}  // namespace sightcell::cli
