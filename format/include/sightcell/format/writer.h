#pragma once
// Encodes a .pvs file (format/SPEC.md) into memory. The caller writes the bytes to disk: see write_file.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Cell sets, asked for one at a time: all of them together, uncompressed, can be larger than the memory. Belongs to the
// caller, as does all that get refers to.
struct cell_set_source {
  // How many there are: one per cell.
  std::size_t count = 0;
  // Puts the source ids of a cell, then polygon_count + v for each volume v, strictly ascending, into set, which comes
  // empty and keeps its storage from cell to cell. encode asks several times for each cell, each time in ascending
  // order, on the thread that called it, and must be told the same. Anything but ok ends encode, which answers the
  // same; so does an exception, which passes through it where the writer is built with them.
  std::function<status(std::uint32_t cell, std::vector<std::uint32_t>& set)> get;
};

// Sets that lie in memory: what sets views must live as long as the source.
cell_set_source sets_of(std::span<const std::vector<std::uint32_t>> sets);

// In which order polygons are stored. Instanced: draws with the same order are instances of one thing, and have as many
// polygons. Merged: every draw group has one of its own, of the same number, and the source has the polygons of a group
// as those of its draws, one draw behind the other.
struct stored_order {
  // One per draw, in the order of the draw table: 0, then as before or the next number.
  std::span<const std::uint32_t> order_of_draw;
  // [i]: which polygon of the draw, or the draw group, as the source has them, is i-th.
  std::span<const std::vector<std::uint32_t>> orders;
};

// Where cells lie on a lattice, which takes a tenth of the bytes of boxes. Places ascend as lattice_comes_before says.
struct lattice_cells {
  lattice_shape shape;
  std::span<const lattice_place> places;  // one per cell
};

// Coarse boxes of space that cells see or not (SPEC.md, "Volumes"): shape is that of a place, all places are of level
// 0, in the order that the file stores.
struct lattice_volumes {
  lattice_shape shape;
  std::span<const lattice_place> places;  // none: a file without volumes
};

// The order in which a file has the cells of a lattice: by level, then by chunks of 8 x 8.
[[nodiscard]] bool lattice_comes_before(const lattice_place& a, const lattice_place& b) noexcept;

// Everything a file holds. Spans are only read, and sets only asked for, during the call.
struct file_contents {
  file_facts facts;
  // In stored order: first_stored gapless from 0, every source id once. Merged: group by group; those of a group in the
  // order of the source, with the same material, none that moves beside another.
  std::span<const draw_record> draws;
  std::span<const std::string> named_groups;  // their names, none empty; by draw_record::named_group
  stored_order order;                         // without orders: each draw, or draw group, in the order of the source
  std::span<const box> cells;                 // number of a cell = its index here; none where there is a lattice
  std::optional<lattice_cells> lattice;
  lattice_volumes volumes;
  cell_set_source cell_sets;
  std::span<const certificate_record> certificate;  // empty, or one per cell in cell order
  std::string_view settings;                        // JSON text of the settings that made the file; may be empty
  // Of each set, the share of polygons that encode may add to it, 0 .. 1, in millionths; 0: sets stay as they are. They
  // are chosen to make the file smaller and (draw, first, count) ranges fewer, and no set loses one. Volumes are never
  // added and do not count. facts.slack is what the sets hold too much already; the file says what they hold together.
  double slack = 0.0;
};

// Encodes contents into out (replaced on ok, else left alone). Same contents, same bytes. Besides the file it takes
// the sets of 64 cells at a time, 8 bytes per run of each, and 4 bytes per polygon; with slack about 60 bytes per
// border of these 64 sets, those of several counted once. Allocates; no shared state, any thread. argument: contents
// contradict themselves (unsorted ids, counts that differ, non-finite boxes, two volumes at one place); limit: a number
// is above what the format can hold (layout.h); memory: out of memory.
status encode(const file_contents& contents, std::vector<std::byte>& out);

// Writes bytes beside path under a temporary name, flushes them to the disk, renames over path and flushes the folder:
// path holds either its old content or all of the new. io on failure (disk full, no permission); the temporary file is
// removed then. What is at path already must be a file: a device or a folder is left alone, and the answer is io. path
// is UTF-8.
status write_file(const char* path, std::span<const std::byte> bytes);

// Removes the temporary files that writers of path left beside it when they were killed. For who knows that no other
// writer of path is at work: its temporary file would go as well.
void remove_unfinished(const char* path);

}  // namespace sightcell::format
