#pragma once
// Numbers of JSON.
#include <nlohmann/json.hpp>

namespace sightcell::bake {

// Returns the number with the fewest digits that is nearer to this float than to any other. JSON has no infinities: the
// largest float is in their place.
double short_number(float value);

// As above, without a fraction if it has none.
nlohmann::ordered_json short_json(float value);

}  // namespace sightcell::bake
