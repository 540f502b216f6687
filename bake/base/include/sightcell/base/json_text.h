#pragma once
// Parses JSON. nlohmann's parse() takes longer to compile than most of our files, so one file instantiates it. Not
// installed: installed headers do not need that library.
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace sightcell::scene {

// Returns the value of a JSON text.
// may_throw: what a text that is not JSON gives: nlohmann::json::exception if true, a discarded value if false.
nlohmann::json parse_json(std::string_view text, bool may_throw = true);

// As above; members of objects keep their order.
nlohmann::ordered_json parse_ordered_json(std::string_view text, bool may_throw = true);

}  // namespace sightcell::scene
