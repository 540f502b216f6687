#pragma once
// Adds an importance section to an encoded file (SPEC.md, "Importance"), or removes it. It is added after encoding,
// because slack is chosen then: only then all polygons of a set are known.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/importance_classes.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Classes of the polygons of each cell, one cell at a time. Belongs to the caller, with everything that get refers to.
struct importance_source {
  // Appends the classes of a cell to classes, which is empty and keeps its storage from cell to cell: one per polygon
  // of the set, in stored order, 0 .. 15. put_importance calls it twice for each cell, each time in ascending order, on
  // its own thread, and needs the same result. A status other than ok ends put_importance with this status.
  std::function<status(std::uint32_t cell, std::vector<std::uint8_t>& classes)> get;
};

// Copies a file and adds an importance section at its end, or replaces the one that it has. The rest of the file is
// unchanged. The same classes give the same bytes.
// file: an encoded file. Its bytes must not be those of out.
// out: replaced on ok, else unchanged.
// Fails with argument (not one class per polygon, or one above 15), version (a file of an older version), limit (too
//   many sections, or a chunk of classes is too large), memory, and the results of reader::open, decode_row and the
//   source.
// Cost: memory for the new file and for one set; no shared state, any thread.
status put_importance(std::span<const std::byte> file, const importance_source& classes, std::vector<std::byte>& out);

// Copies a file without its importance section; the same bytes if it has none. As put_importance.
status remove_importance(std::span<const std::byte> file, std::vector<std::byte>& out);

}  // namespace sightcell::format
