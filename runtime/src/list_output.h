// What the C functions that write lists share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "db.h"
#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// The checks of all list functions. OK: dst has room for need elements.
inline sightcell_status check_room(const void* dst, std::size_t capacity, std::uint64_t need,
                                   std::size_t* count) noexcept {
  if (count == nullptr || (dst == nullptr && capacity > 0)) return SIGHTCELL_ERR_ARGUMENT;
  if (need > std::numeric_limits<std::size_t>::max()) return SIGHTCELL_ERR_LIMIT;
  *count = static_cast<std::size_t>(need);
  return need > capacity ? SIGHTCELL_ERR_CAPACITY : SIGHTCELL_OK;
}

// Writes the source ids of a range. Returns the end.
inline std::uint32_t* write_sources(const sightcell_db& db, std::uint32_t draw, std::uint32_t first,
                                    std::uint32_t count, std::uint32_t* dst) noexcept {
  const std::uint32_t first_source = db.first_source(draw);
  for (const std::uint32_t polygon : db.sources_in(draw, first, count)) *dst++ = first_source + polygon;
  return dst;
}

}  // namespace sightcell::runtime
