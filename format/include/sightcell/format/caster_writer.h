#pragma once
// Adds a casters section to an encoded file (SPEC.md, "Shadow casters"), or removes it. It is added after encoding,
// because the casters of a cell are those beside its final set.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/caster_table.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The casters of each cell and sun, one at a time. Belongs to the caller, with everything that get refers to.
struct caster_source {
  std::vector<sun_record> suns;  // 1 .. max_suns
  // Appends the source ids of the casters, strictly ascending, to casters, which is empty and keeps its storage.
  // put_casters calls it several times for each cell and sun, on its own thread, and needs the same result. A status
  // other than ok ends put_casters with this status.
  std::function<status(std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& casters)> get;
  // One for each cell and sun, the suns of a cell one after the other. `cell` is not used.
  std::span<const certificate_record> certificate;
};

// Copies a file and adds a casters section at its end, or replaces the one that it has. The rest of the file is
// unchanged. The same casters give the same bytes.
// file: an encoded file. Its bytes must not be those of out.
// out: replaced on ok, else unchanged.
// Fails with argument (no sun, a direction that is no unit vector, casters that are not ascending or do not exist,
//   another number of certificates), version (a file of an older version), limit (too many sections, suns, or sets),
//   memory, and the results of reader::open and the source.
// Cost: memory for the new file; no shared state, any thread.
status put_casters(std::span<const std::byte> file, const caster_source& casters, std::vector<std::byte>& out);

// Copies a file without its casters section; the same bytes if it has none. As put_casters.
status remove_casters(std::span<const std::byte> file, std::vector<std::byte>& out);

}  // namespace sightcell::format
