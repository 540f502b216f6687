#pragma once
// Pictures of one floor of a scene from above, as a map: the scene cut open at eye height, with areas drawn over it.
// +x is to the right, -z is up. Drawn by the processor, without OpenGL. scene.h has the conventions.
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"

namespace sightcell::picture {

// A rectangle of the plan, in meters.
struct plan_rectangle {
  float min_x = 0.0f, min_z = 0.0f, max_x = 0.0f, max_z = 0.0f;
};

struct plan_area {
  plan_rectangle where;
  float ground = 0.0f;  // meters: the height of what people stand on there
  float color = 0.0f;   // 0: blue, then green and orange, 1: red
};

// A line of the legend with the color of areas.
struct plan_key {
  float color = 0.0f;
  std::string text;
};

struct plan_mark {
  float x = 0.0f, z = 0.0f;  // meters
};

struct floor_plan {
  plan_rectangle frame;          // what is shown; 2 m more on each side. Not empty
  std::vector<plan_area> areas;  // at least one. Narrow ones are drawn over wide ones
  std::vector<plan_mark> marks;  // small discs
  std::string title;             // ASCII; below the map
  std::vector<plan_key> legend;  // beside a scale bar
  bool bare = false;             // the map alone: no areas, no marks, and no strip of text
};

// Returns how many pixels a meter has: 16 for a frame of up to 128 m, 8 for up to 512 m, and half of that until the
// longer side is at most 4096 pixels.
double plan_scale(const plan_rectangle& frame);

// Returns what the map of a frame shows: the frame and its border, up to whole pixels.
plan_rectangle plan_extent(const plan_rectangle& frame);

// Draws the plan.
// geometry: polygons that are absent or of alpha_mode::blend are not drawn. What is above eye height (1.6 m over the
//   ground of the nearest area) is cut off: light gray is ground, darker where it is lower; black are walls at the cut;
//   dark gray is the inside of solids, which is where a polygon above or below is seen from behind; white is where
//   nothing is below.
// Returns the picture: the map, and a strip of some lines of text below it. The same bytes on every machine.
// Cost: O(polygons + pixels); 13 bytes per pixel beside the picture.
image_rgba draw_floor_plan(const scene::world_geometry& geometry, const floor_plan& plan);

}  // namespace sightcell::picture
