#pragma once
// Encodes the sets of a section of its own (extra_sets.h) for a file that is encoded already.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

struct encoded_sets {
  std::uint32_t run_bound = 0, list_bound = 0;
  std::vector<std::byte> bytes;  // from the certificate to the end of the section
};

// Encodes sets of source ids of polygons. certificate: one for each set.
// argument: a set is not ascending, has what does not exist, or the certificates are invalid or of another number;
// limit: the sets are too large; the status of the source. Allocates.
status encode_sets(const reader& file, const cell_set_source& sets, std::span<const certificate_record> certificate,
                   encoded_sets& out);

}  // namespace sightcell::format
