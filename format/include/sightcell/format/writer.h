#pragma once
// Encodes a .pvs file (format/SPEC.md) into memory. The caller writes the bytes to disk: see write_file.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Everything a file holds. Spans are only read during the call.
struct file_contents {
  file_facts facts;
  std::span<const draw_record> draws;                     // ascending first_source, gapless, summing to polygon_count
  std::span<const box> cells;                             // number of a cell = its index here
  std::span<const std::vector<std::uint32_t>> cell_sets;  // per cell: source ids, strictly ascending
  std::span<const certificate_record> certificate;        // empty, or one per cell in cell order
  std::string_view settings;                              // JSON text of the settings that made the file; may be empty
};

// Encodes contents into out (replaced). Same contents, same bytes. Allocates; no shared state, any thread.
// argument: contents contradict themselves (unsorted ids, counts that differ, non-finite boxes); limit: a number is
// above what the format can hold (layout.h); memory: out of memory.
status encode(const file_contents& contents, std::vector<std::byte>& out);

// Writes bytes beside path under a temporary name, flushes them to the disk, renames over path and flushes the folder:
// path holds either its old content or all of the new. io on failure (disk full, no permission); the temporary file is
// removed then. path is UTF-8.
status write_file(const char* path, std::span<const std::byte> bytes);

}  // namespace sightcell::format
