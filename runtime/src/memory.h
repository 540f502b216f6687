#pragma once
// The caller's allocator, or malloc, behind one pair of functions.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>

#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// Alignment of all blocks, the most that alloc is asked for: 16, or less where malloc guarantees less (8 on s390x).
inline constexpr std::size_t block_alignment = std::min<std::size_t>(16, alignof(std::max_align_t));

// malloc and free.
sightcell_allocator default_allocator() noexcept;

// Null if out of memory, or if size exceeds size_t. size: above 0.
void* allocate(const sightcell_allocator& mem, std::uint64_t size) noexcept;
// block: may be null. size: as given to allocate.
void release(const sightcell_allocator& mem, void* block, std::uint64_t size) noexcept;

// Constructs elements: as zeros, if their type has no initial values of its own.
template <class T>
void construct(T* first, std::uint64_t count) noexcept {
  const auto elements = static_cast<std::size_t>(count);
  if constexpr (std::is_trivially_default_constructible_v<T>) {
    std::memset(static_cast<void*>(first), 0, elements * sizeof(T));
  } else {
    std::uninitialized_value_construct_n(first, elements);
  }
}

// Divides one block into arrays. Run once with a null block to get the size, then again with the block.
class carver {
 public:
  explicit carver(void* block) noexcept : block_(static_cast<std::byte*>(block)) {}

  template <class T>
  T* take(std::uint64_t count) noexcept {
    static_assert(alignof(T) <= block_alignment);
    used_ = (used_ + alignof(T) - 1) / alignof(T) * alignof(T);
    T* first = block_ == nullptr ? nullptr : reinterpret_cast<T*>(block_ + used_);
    used_ += count * sizeof(T);
    return first;
  }

  [[nodiscard]] std::uint64_t used() const noexcept { return used_; }

 private:
  std::byte* block_;
  std::uint64_t used_ = 0;
};

}  // namespace sightcell::runtime
