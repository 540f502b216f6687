#pragma once
// glTF's three ways of treating alpha.
#include <cstdint>

namespace sightcell::scene {

enum class alpha_mode : std::uint8_t { opaque, mask, blend };

}  // namespace sightcell::scene
