#pragma once
// A .pvs file inside of a .glb (docs/baking.md, --embed).
#include <cstddef>
#include <span>

#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// Finds the .pvs file in a .glb: the buffer view that the JSON names at extras.sightcell.pvs.bufferView.
// bytes: of any file.
// out: receives the part of bytes; all of them if they are not a .glb.
// Returns OK; ABSENT for a .glb without a .pvs file; TRUNCATED if it is shorter than its header states; CORRUPT if it
// has no JSON, or names a view that there is not. The JSON is only checked as far as it is read. Cost: one or two
// passes over the JSON of a .glb; no allocation.
sightcell_status find_embedded_pvs(std::span<const std::byte> bytes, std::span<const std::byte>& out) noexcept;

}  // namespace sightcell::runtime
