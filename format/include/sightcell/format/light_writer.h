#pragma once
// Adds a lights section to an encoded file (SPEC.md, "Lights"), or removes it. It is added after encoding, because
// which lights touch a cell depends on its final set.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/light_table.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Belongs to the caller, with everything that the functions refer to.
struct light_source {
  std::vector<light_record> lights;  // 1 .. max_lights
  // The source ids of the polygons that each light reaches, by its number.
  cell_set_source sets;
  // Returns whether a light reaches a polygon of the set of a cell. Called once for each.
  std::function<bool(std::uint32_t cell, std::uint32_t light)> touches;
  // One for each light. `cell` is not used.
  std::span<const certificate_record> certificate;
};

// Copies a file and adds a lights section at its end, or replaces the one that it has. The rest of the file is
// unchanged. The same lights give the same bytes.
// file: an encoded file. Its bytes must not be those of out.
// out: replaced on ok, else unchanged.
// Fails with argument (no light, a number out of range, polygons that are not ascending or do not exist, another number
//   of sets or certificates), version (a file of an older version), limit (too many sections or lights), memory, and
//   the results of reader::open and the source.
// Cost: memory for the new file; no shared state, any thread.
status put_lights(std::span<const std::byte> file, const light_source& lights, std::vector<std::byte>& out);

// Copies a file without its lights section; the same bytes if it has none. As put_lights.
status remove_lights(std::span<const std::byte> file, std::vector<std::byte>& out);

}  // namespace sightcell::format
