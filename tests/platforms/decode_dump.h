#pragma once
// Everything that the C runtime decodes of a file, as text that is the same on every platform.
#include <string>

#include "fnv_hash.h"
#include "sightcell/sightcell.h"

namespace sightcell::test {

// Prints header, draws, order, and for each cell its box, set, draw ranges and a hash of its index list. The lines
// version, fingerprint, polygons, margin, max_pixel_error, confidence, draw and cell are those of
// tests/golden/decode_pvs.py. Where the runtime contradicts itself (ranges that are not the set, an error), a line
// begins with "WRONG".
std::string dump(const sightcell_db* db);

}  // namespace sightcell::test
