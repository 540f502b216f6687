#pragma once
// What is visible of a scene from above once everything above a cut is taken away.
#include <cstdint>
#include <vector>

#include "sightcell/picture/floor_plan.h"

namespace sightcell::picture {

// The pixels of a map. Row 0 is at the lowest z.
struct plan_shape {
  double min_x = 0.0, min_z = 0.0;  // meters: the corner of the first pixel
  double scale = 1.0;               // pixels per meter
  std::int32_t width = 0, height = 0;
};

// Heights are in meters, one value per pixel, in rows.
struct plan_surface {
  std::vector<float> ground;        // that of the nearest area
  std::vector<float> top;           // of the highest polygon below the cut; no_surface: none
  std::vector<std::uint8_t> light;  // of that polygon: 0 dark to 255
  std::vector<std::uint8_t> flags;
};
inline constexpr float no_surface = -3.0e38f;
inline constexpr std::uint8_t plan_wall = 1;    // a polygon passes through the cut
inline constexpr std::uint8_t plan_inside = 2;  // the polygon below the cut, or that above, is seen from behind
inline constexpr std::uint8_t plan_lower_back = 4, plan_upper_back = 8;
inline constexpr std::uint8_t plan_near = 16;  // an area is there or near

inline constexpr double plan_cut = 1.6;  // meters above the ground

// Returns the surface. areas: at least one.
plan_surface look_from_above(const scene::world_geometry& geometry, const plan_shape& shape,
                             const std::vector<plan_area>& areas);

}  // namespace sightcell::picture
