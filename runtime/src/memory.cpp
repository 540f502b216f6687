#include "memory.h"

#include <cstdlib>
#include <limits>

namespace sightcell::runtime {
namespace {

void* malloc_block(void*, std::size_t size, std::size_t align) {
  static_assert(block_alignment <= alignof(std::max_align_t), "malloc must do");
  return align <= alignof(std::max_align_t) ? std::malloc(size) : nullptr;
}

void free_block(void*, void* block, std::size_t) {
  std::free(block);
}

}  // namespace

sightcell_allocator default_allocator() noexcept {
  return {malloc_block, free_block, nullptr};
}

void* allocate(const sightcell_allocator& mem, std::uint64_t size) noexcept {
  if (size > std::numeric_limits<std::size_t>::max()) return nullptr;
  return mem.alloc(mem.user, static_cast<std::size_t>(size), block_alignment);
}

void release(const sightcell_allocator& mem, void* block, std::uint64_t size) noexcept {
  if (block != nullptr) mem.release(mem.user, block, static_cast<std::size_t>(size));
}

}  // namespace sightcell::runtime
