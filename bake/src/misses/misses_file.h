#pragma once
// Reads misses that a host found from a JSON file: {"misses":[{"eye":[x,y,z],"polygon":1234}]}. Other members are
// ignored except "scene_fingerprint", 32 hex digits as `sightcell info` prints them, which is checked because source
// ids are valid for one scene only.
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// A polygon that should have been drawn for a camera at the eye.
struct reported_miss {
  glm::vec3 eye{0.0f};        // meters
  std::uint32_t polygon = 0;  // source id
  bool operator==(const reported_miss&) const = default;
};

// Returns the misses in the order of the file, with finite eyes and polygons of the scene. Throws sightcell::error
// (bad_input) with the file, the number of the miss and the cause.
std::vector<reported_miss> read_misses(const std::filesystem::path& path, const scene::scene& s);
// Does the same for text; subject is the name for errors.
std::vector<reported_miss> parse_misses(std::string_view text, const std::string& subject, const scene::scene& s);

}  // namespace sightcell::bake
