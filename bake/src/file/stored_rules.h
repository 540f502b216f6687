#pragma once
// The settings of a bake that define visibility, read from the settings text of its file, for tools that trace the
// scene again.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/scene/animated_as.h"

namespace sightcell::bake {

// Defaults are used where the text has no value.
struct stored_rules {
  float player_radius = 0.05f;  // meters, in the range of the setting
  float smallest_gap = 0.0f;    // meters; 0 for files from before visibility rule 3
  bool all_double_sided = false;
  scene::animated_as animated = scene::animated_as::always;
  std::vector<std::string> closed;  // named groups that occlude
  std::uint64_t seed = 1;
};

// Returns the rules in the text. Values out of range are clamped.
stored_rules stored_rules_of(std::string_view settings);

}  // namespace sightcell::bake
