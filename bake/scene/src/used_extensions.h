#pragma once
// The extensions that a part of a document uses.
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>

namespace sightcell::scene {

// Returns the names of all members of objects "extensions", at any depth. Extensions that change only what is allowed,
// such as KHR_mesh_quantization, are not among them.
std::set<std::string> used_extensions(const nlohmann::json& top);

}  // namespace sightcell::scene
