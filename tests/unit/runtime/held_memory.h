#pragma once
// An allocator that counts the bytes that it has not got back; for any number of threads.
#include <atomic>
#include <cstdlib>

#include "sightcell/sightcell.h"

namespace sightcell::test {

struct held_memory {
  std::atomic<std::size_t> bytes{0};
  sightcell_allocator interface {
    [](void* user, std::size_t size, std::size_t) -> void* {
      static_cast<held_memory*>(user)->bytes += size;
      return std::malloc(size);
    },
        [](void* user, void* block, std::size_t size) {
          static_cast<held_memory*>(user)->bytes -= size;
          std::free(block);
        },
        this
  };
};

}  // namespace sightcell::test
