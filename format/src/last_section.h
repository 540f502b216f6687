#pragma once
// Copies a file with another optional section: for sections that are made when the rest of the file is known.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Writes the sections of a file without those of an id, then `last` as an optional section of this id.
// file: opened from bytes.
// last: the bytes of the section; none: the file has no such section afterwards.
// out: replaced on ok, else unchanged. limit: too many sections. Allocates.
status with_last_section(const reader& file, std::span<const std::byte> bytes, std::uint32_t id,
                         std::optional<std::span<const std::byte>> last, std::vector<std::byte>& out);

// As with_last_section, for a section that belongs to the front of a file: it is written before the first bulk section.
status with_front_section(const reader& file, std::span<const std::byte> bytes, std::uint32_t id,
                          std::optional<std::span<const std::byte>> section, std::vector<std::byte>& out);

}  // namespace sightcell::format
