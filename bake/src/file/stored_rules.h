#pragma once
// What a bake was told about seeing, as the settings text of its file says: for who looks at the scene again.
#include <cstdint>
#include <string_view>

#include "sightcell/scene/animated_as.h"

namespace sightcell::bake {

struct stored_rules {
  float player_radius = 0.05f;  // metres, in the range of the setting
  float smallest_gap = 0.0f;    // metres; files from before rule 3 have none
  bool all_double_sided = false;
  scene::animated_as animated = scene::animated_as::always;
  std::uint64_t seed = 1;
};

// What the text does not say is as above; nor is what it says out of range.
stored_rules stored_rules_of(std::string_view settings);

}  // namespace sightcell::bake
