#pragma once
// How alpha is treated, in glTF's terms.
#include <cstdint>

namespace sightcell::scene {

enum class alpha_mode : std::uint8_t { opaque, mask, blend };

// What a texture shows beyond 0 and 1.
enum class wrap : std::uint8_t { repeat, clamp, mirror };

}  // namespace sightcell::scene
