#pragma once
// What a kind of town looks like, in numbers. The default is the plain walled town of --polygons; presets are richer.
#include <array>
#include <cstdint>
#include <string_view>

namespace sightcell::city {

// Streets, blocks and lots. Meters.
struct plan_style {
  std::array<double, 4> street_widths = {11.0, 5.5, 14.0, 8.5};  // between building lines, street after street
  double boundary_width = 10.0;                                  // of the streets along the town's rim
  double block_low = 58.0, block_high = 70.0;                    // from street to street
  double building_depth = 11.0;
  double lot_width = 11.0;
  std::uint32_t sunken_every = 0;  // every so many streets along x lie sunken, bridges over them; 0: none
  double sunken_width = 18.0;      // between building lines; the sunken floor is 10 m of it
  bool has_covered_passages = false;
};

struct style {
  std::string_view name;
  std::uint64_t polygons = 0;  // of the preset
  std::uint32_t polygons_per_block = 0;
  bool has_towers = false;  // towers of overlapping panels instead of closed rows of houses
  std::uint32_t floors_low = 3, floors_more = 4;
  double relief_height = 0.0;    // between the lowest and the highest ground, at most
  double relief_length = 150.0;  // from a hill to the next hollow, about
  double dressing = 1.0;         // share of the places for clutter that are tried
  plan_style plan;
};

inline constexpr double sunken_depth = 4.6;       // below the ground around
inline constexpr double sunken_half_width = 5.0;  // of the floor, measured along the street that crosses
inline constexpr double passage_head_room = 3.6;

// Null when there is none of that name.
const style* find_preset(std::string_view name);
std::string_view preset_names();  // "a, b or c", for messages

}  // namespace sightcell::city
