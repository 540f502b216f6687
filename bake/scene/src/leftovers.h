#pragma once
// Removes from a changed document what is about the unchanged one.
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>

namespace sightcell::scene {

// Removes extensions from the lists of a document that only compression, or meshes that are gone, used.
// before: those that were used before the change.
void drop_extensions(nlohmann::json& document, const std::set<std::string>& before);

// Removes the .pvs file of the scene, which is about its polygons in their order.
void drop_embedded_pvs(nlohmann::json& document);

}  // namespace sightcell::scene
