#pragma once
// Pictures of the place where a .pvs file fails most: full, culled, and what differs.
#include <filesystem>
#include <string>
#include <vector>

#include "pvs_file.h"
#include "sightcell/bake/verify.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

// Returns the camera of the picture of a missing polygon: at missing.eye, toward missing.target; narrow enough that a
// small polygon is larger than a pixel, wide enough to recognize the surroundings.
picture::camera camera_of(const scene::world_geometry& world, const bake::missing_polygon& missing);

struct worst_view {
  std::vector<std::filesystem::path> pictures;  // full, culled, difference
  std::uint64_t differing_pixels = 0;
  double color_error = 0.0;
};

// Looks from missing.eye at missing.target and writes PREFIX.worst-full.png, -culled and -difference. Throws
// sightcell::error, "gl.no-context" where there is no EGL.
worst_view draw_worst_view(const scene::scene& s, const pvs_file& file, const bake::missing_polygon& missing,
                           const std::string& prefix);

}  // namespace sightcell::cli
