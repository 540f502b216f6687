#pragma once
// Reads the size of lattice cells or of grid steps, with which their bytes begin.
#include <cstdint>

#include "checked_reader.h"
#include "record_rules.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

inline constexpr std::uint64_t shape_size = 16;  // bytes: f64 width, f64 height

// False unless the shape is valid.
[[nodiscard]] inline bool read_shape(const checked_reader& in, lattice_shape& out) noexcept {
  return in.read_f64(0, out.width) && in.read_f64(8, out.height) && shape_is_valid(out);
}

}  // namespace sightcell::format
