#pragma once
// Puts an importance section into an encoded file (SPEC.md, "Importance"), or takes it out. It comes after the rows,
// since which polygons a set holds besides those that are seen is known only when they are encoded.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/importance_classes.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Classes of the polygons of each cell, asked for one cell at a time. Belongs to the caller, as does all that get
// refers to.
struct importance_source {
  // Puts the classes of a cell into classes, which comes empty and keeps its storage from cell to cell: one for each
  // polygon of the cell's set, in stored order, 0 .. 15. put_importance asks twice for each cell, each time in
  // ascending order, on the thread that called it, and must be told the same. Anything but ok ends it with the same.
  std::function<status(std::uint32_t cell, std::vector<std::uint8_t>& classes)> get;
};

// file with an importance section behind its last one, in place of one that it may have, into out (replaced on ok, else
// left alone; must not be what file views). All else of the file stays what it is. The same classes give the same
// bytes. Takes the new file's bytes and one set at a time. Allocates; no shared state, any thread.
// argument: a cell has not as many classes as polygons, or one above 15; version: the file is of an older version;
// limit: too many sections, or a chunk of classes is too large; what reader::open, decode_row and the source answer;
// memory: out of memory.
status put_importance(std::span<const std::byte> file, const importance_source& classes, std::vector<std::byte>& out);

// file without an importance section, into out; the same bytes where it has none. As put_importance.
status remove_importance(std::span<const std::byte> file, std::vector<std::byte>& out);

}  // namespace sightcell::format
