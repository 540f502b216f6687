#include "leftovers.h"

#include <nlohmann/json.hpp>

#include "used_extensions.h"

namespace sightcell::scene {

using nlohmann::json;

void drop_extensions(json& document, const std::set<std::string>& before) {
  const std::set<std::string> after = used_extensions(document);
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    const auto found = document.find(list);
    if (found == document.end()) continue;
    json left = json::array();
    for (const json& name : *found)
      if (!before.contains(name.get<std::string>()) || after.contains(name.get<std::string>())) left.push_back(name);
    if (left.empty())
      document.erase(found);
    else
      *found = std::move(left);
  }
}

void drop_embedded_pvs(json& document) {
  const auto extras = document.find("extras");
  if (extras == document.end() || !extras->is_object()) return;
  const auto marks = extras->find("sightcell");
  if (marks != extras->end() && marks->is_object()) marks->erase("pvs");
}

}  // namespace sightcell::scene
