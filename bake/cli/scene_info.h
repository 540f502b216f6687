#pragma once
// What `sightcell info` says of a scene.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sightcell/scene/scene.h"

namespace sightcell::cli {

// The keys are documented in docs/json-files.md.
nlohmann::ordered_json scene_info(const scene::scene& s);

// Adds what the .pvs file is that the scene contains or names, as "embedded"; null if there is none. One that cannot be
// read is a warning.
// s: the scene of the file with this path.
void add_embedded(const std::filesystem::path& path, const scene::scene& s, nlohmann::ordered_json& info);

// The same for people.
void print_scene_info(const std::filesystem::path& path, const nlohmann::ordered_json& info);

}  // namespace sightcell::cli
