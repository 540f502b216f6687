#pragma once
// A recorded path: where a camera was in each frame, as text that is small enough to be kept with the sources.
#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

namespace sightcell::bench {

struct path_frame {
  glm::vec3 eye{0.0f};   // meters, world space
  float heading = 0.0f;  // radians; 0 looks along -Z, a quarter turn along +X. Level.

  glm::vec3 forward() const;
};

// A line per frame: x y z heading. Lines that begin with # say what it is. Throws std::runtime_error.
std::vector<path_frame> read_path(const std::filesystem::path& file);
void write_path(const std::filesystem::path& file, const std::vector<path_frame>& path);

}  // namespace sightcell::bench
