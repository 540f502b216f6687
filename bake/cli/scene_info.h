#pragma once
// What `sightcell info` says of a scene.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sightcell/scene/scene.h"

namespace sightcell::cli {

// The keys are documented in docs/json-files.md.
nlohmann::ordered_json scene_info(const scene::scene& s);

// The same for people.
void print_scene_info(const std::filesystem::path& path, const nlohmann::ordered_json& info);

}  // namespace sightcell::cli
