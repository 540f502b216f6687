#pragma once
// The frames that are drawn: camera cuts, and a walk.
#include <cstdint>
#include <string>
#include <vector>

#include "camera.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"

namespace gpu_driven {

enum class frame_kind : std::uint8_t {
  unmeasured,  // drawn only, so that modes with a history have one
  cut,         // the first frame after a cut
  settled,     // the third frame after a cut, of the same view
  walk,        // a frame of the walk
  turn         // a frame of the walk in which the camera turns fast
};

struct tour_frame {
  camera view;
  frame_kind kind = frame_kind::unmeasured;
};

// Three frames from a random valid viewpoint in a random direction, `cuts` times.
// Throws gpu-driven.no-viewpoint if the file has no viewpoints: the middle of a cell may be in a wall, where no set
// holds.
std::vector<tour_frame> make_cuts(const sightcell::db& db, const std::string& file, std::uint32_t cuts,
                                  std::uint64_t seed);

// A walk of `frames` measured frames from viewpoint to viewpoint of neighboring cells, where nothing is in the way, in
// cells only. Now and then the camera turns around on the spot. Where no way goes on, the camera jumps, and three
// frames are not measured.
// jumps: receives their number.
std::vector<tour_frame> make_walk(const sightcell::db& db, const std::string& file,
                                  const sightcell::scene::world_geometry& world, std::uint32_t frames,
                                  std::uint64_t seed, std::uint32_t& jumps);

}  // namespace gpu_driven
