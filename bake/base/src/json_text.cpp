#include "sightcell/base/json_text.h"

#include <nlohmann/json.hpp>

namespace sightcell::scene {

nlohmann::json parse_json(std::string_view text, bool may_throw) {
  return nlohmann::json::parse(text, nullptr, may_throw);
}

nlohmann::ordered_json parse_ordered_json(std::string_view text, bool may_throw) {
  return nlohmann::ordered_json::parse(text, nullptr, may_throw);
}

}  // namespace sightcell::scene
