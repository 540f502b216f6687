#pragma once
// Adds a texture residency section to an encoded file (SPEC.md, "Texture residency"), or removes it. It is added after
// encoding, because the levels of a cell depend on its final set.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/residency_table.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The levels of each cell, one cell at a time. Belongs to the caller, with everything that get refers to.
struct residency_source {
  std::vector<texture_record> textures;  // ascending images
  float pixels_per_radian = 0.0f, anisotropy = 1.0f;
  // Writes the number of the level of each texture of a cell to levels, which has one element for each.
  // put_residency calls it several times for each cell, in ascending order, on its own thread, and needs the same
  // result. A status other than ok ends put_residency with this status.
  std::function<status(std::uint32_t cell, std::span<std::uint8_t> levels)> get;
};

// Copies a file and adds a section, before the rows, or replaces the one that it has. The rest of the file is
// unchanged. The same levels give the same bytes.
// file: an encoded file. Its bytes must not be those of out.
// out: replaced on ok, else unchanged.
// Fails with argument (images that do not ascend, a side or a level that is out of range), version (a file of an older
//   version), limit (too many sections or textures), memory, and the results of reader::open and the source.
// Cost: memory for the new file; no shared state, any thread.
status put_residency(std::span<const std::byte> file, const residency_source& source, std::vector<std::byte>& out);

// Copies a file without its section; the same bytes if it has none. As put_residency.
status remove_residency(std::span<const std::byte> file, std::vector<std::byte>& out);

}  // namespace sightcell::format
