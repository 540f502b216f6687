#pragma once
// JSON text into nlohmann's values, for everybody who stands on scene. What its parse() instantiates takes longer to
// compile than most of our files, so it is done once. Not installed: no public header of ours needs that library.
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace sightcell::scene {

// What is no JSON throws nlohmann::json::exception, or gives a discarded value where nothing may be thrown.
nlohmann::json parse_json(std::string_view text, bool may_throw = true);
nlohmann::ordered_json parse_ordered_json(std::string_view text, bool may_throw = true);

}  // namespace sightcell::scene
