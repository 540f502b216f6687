#pragma once
// Polygons that a host found missing, from a JSON file: {"misses":[{"eye":[x,y,z],"polygon":1234}]}. Other members are
// passed over, but for "scene_fingerprint", 32 hex digits as `sightcell info` shows them: of another scene ids mean
// nothing.
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// From the eye the polygon ought to have been drawn.
struct reported_miss {
  glm::vec3 eye{0.0f};        // metres
  std::uint32_t polygon = 0;  // source id
  bool operator==(const reported_miss&) const = default;
};

// In the order of the file. Eyes are finite, polygons are of the scene. Throws sightcell::error (bad_input) that names
// the file, which miss it is and what is wrong with it.
std::vector<reported_miss> read_misses(const std::filesystem::path& path, const scene::scene& s);
// The same from text; subject names it in errors.
std::vector<reported_miss> parse_misses(std::string_view text, const std::string& subject, const scene::scene& s);

}  // namespace sightcell::bake
