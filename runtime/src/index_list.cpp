#include "index_list.h"

#include <cstring>

namespace sightcell::runtime {

void copy_indices(std::span<const format::run> runs, const std::uint32_t* stored_indices, std::uint32_t* dst) noexcept {
  for (const format::run& r : runs) {
    const std::uint32_t* from = stored_indices + std::size_t{3} * r.first;
    const std::size_t count = std::size_t{3} * r.count;
    std::memcpy(dst, from, count * sizeof(std::uint32_t));
    dst += count;
  }
}

}  // namespace sightcell::runtime
