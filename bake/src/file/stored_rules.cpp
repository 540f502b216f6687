#include "file/stored_rules.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "sightcell/bake/settings.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bake {

stored_rules stored_rules_of(std::string_view settings_text) {
  stored_rules rules;
  rules.player_radius = settings{}.player_radius;
  const auto text = scene::parse_json(settings_text, false);
  if (!text.is_object()) return rules;
  if (const auto radius = text.find("player_radius"); radius != text.end() && radius->is_number())
    rules.player_radius = std::clamp(radius->get<float>(), 0.001f, 1.0f);
  if (const auto gap = text.find("smallest_gap"); gap != text.end() && gap->is_number())
    rules.smallest_gap = std::clamp(gap->get<float>(), 0.0f, 0.1f);
  if (const auto both = text.find("all_double_sided"); both != text.end() && both->is_boolean())
    rules.all_double_sided = both->get<bool>();
  if (const auto animated = text.find("animated"); animated != text.end() && animated->is_string())
    rules.animated = scene::animated_as_of(animated->get<std::string>()).value_or(rules.animated);
  if (const auto closed = text.find("closed"); closed != text.end() && closed->is_array())
    for (const auto& name : *closed)
      if (name.is_string()) rules.closed.push_back(name.get<std::string>());
  if (const auto seed = text.find("seed"); seed != text.end() && seed->is_number_unsigned())
    rules.seed = seed->get<std::uint64_t>();
  return rules;
}

}  // namespace sightcell::bake
