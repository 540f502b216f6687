#pragma once
// The caller's allocator, or malloc, behind one pair of functions.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// Every block is aligned to this; alloc is never asked for more. 16, or less on the machines where malloc promises less
// (8 on s390x).
inline constexpr std::size_t block_alignment = std::min<std::size_t>(16, alignof(std::max_align_t));

// malloc and free.
sightcell_allocator default_allocator() noexcept;

// Null when out of memory, or when size does not fit the machine. size: above 0.
void* allocate(const sightcell_allocator& mem, std::uint64_t size) noexcept;
// Null is fine. size: as given to allocate.
void release(const sightcell_allocator& mem, void* block, std::uint64_t size) noexcept;

// Cuts one block into arrays. Run once with a null block to learn the size, then again with the block.
class carver {
 public:
  explicit carver(void* block) noexcept : block_(static_cast<std::byte*>(block)) {}

  template <class T>
  T* take(std::uint64_t count) noexcept {
    static_assert(alignof(T) <= block_alignment);
    used_ = (used_ + alignof(T) - 1) / alignof(T) * alignof(T);
    T* place = block_ == nullptr ? nullptr : reinterpret_cast<T*>(block_ + used_);
    used_ += count * sizeof(T);
    return place;
  }

  [[nodiscard]] std::uint64_t used() const noexcept { return used_; }

 private:
  std::byte* block_;
  std::uint64_t used_ = 0;
};

}  // namespace sightcell::runtime
