#include "used_extensions.h"

#include <nlohmann/json.hpp>
#include <vector>

namespace sightcell::scene {

// Uses its own stack, because files may be hostile.
std::set<std::string> used_extensions(const nlohmann::json& top) {
  std::set<std::string> names;
  std::vector<const nlohmann::json*> open{&top};
  while (!open.empty()) {
    const nlohmann::json& value = *open.back();
    open.pop_back();
    if (!value.is_structured()) continue;
    const auto found = value.is_object() ? value.find("extensions") : value.end();
    if (found != value.end() && found->is_object())
      for (auto it = found->begin(); it != found->end(); ++it) names.insert(it.key());
    for (const nlohmann::json& inner : value) open.push_back(&inner);
  }
  return names;
}

}  // namespace sightcell::scene
