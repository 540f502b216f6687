#pragma once
// Reads a .pvs file from disk into one block of the caller's allocator.
#include <cstdint>

#include "memory.h"

namespace sightcell::runtime {

struct file_block {
  void* bytes = nullptr;
  std::uint64_t size = 0;
};

// Reads the whole file; the caller releases the block. IO: cannot be opened or read; TRUNCATED: empty; LIMIT: larger
// than the address space; MEMORY. path is UTF-8.
sightcell_status read_file(const char* path, const sightcell_allocator& mem, file_block& out) noexcept;

}  // namespace sightcell::runtime
