#include "index_list.h"

#include <cstring>
#include <limits>

namespace sightcell::runtime {

void copy_indices(std::span<const format::run> runs, const std::uint32_t* stored_indices, std::uint32_t* dst) noexcept {
  for (const format::run& r : runs) {
    const std::uint32_t* from = stored_indices + std::size_t{3} * r.first;
    const std::size_t count = std::size_t{3} * r.count;
    std::memcpy(dst, from, count * sizeof(std::uint32_t));
    dst += count;
  }
}

sightcell_status write_indices(std::span<const format::run> runs, const std::uint32_t* stored_indices,
                               std::uint32_t* dst, std::size_t capacity, std::size_t* count) noexcept {
  std::uint64_t polygons = 0;
  for (const format::run& r : runs) polygons += r.count;
  if (3 * polygons > std::numeric_limits<std::size_t>::max()) return SIGHTCELL_ERR_LIMIT;
  *count = static_cast<std::size_t>(3 * polygons);
  if (*count > capacity) return SIGHTCELL_ERR_CAPACITY;
  if (*count > 0 && stored_indices == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  copy_indices(runs, stored_indices, dst);
  return SIGHTCELL_OK;
}

}  // namespace sightcell::runtime
