#pragma once
// zlib streams and the names of files.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "memory.h"

namespace sightcell::streaming {

using content_hash = std::array<std::uint8_t, 8>;

// Returns the first bytes of the SHA-256 of a file.
content_hash hash_of(std::span<const std::uint8_t> file) noexcept;

// A block with the payload of a zlib stream.
class inflated {
 public:
  explicit inflated(const sightcell_allocator& mem) noexcept : mem_(mem) {}
  ~inflated() { runtime::release(mem_, block_, size_); }
  inflated(const inflated&) = delete;
  inflated& operator=(const inflated&) = delete;

  // size: of the payload, as the file states it. Fails with MEMORY, CORRUPT.
  [[nodiscard]] sightcell_status read(std::span<const std::uint8_t> stream, std::uint32_t size) noexcept;
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {static_cast<const std::uint8_t*>(block_), size_};
  }

 private:
  const sightcell_allocator& mem_;
  void* block_ = nullptr;
  std::uint32_t size_ = 0;
};

// Little-endian.
inline std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return bytes[at] | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

}  // namespace sightcell::streaming
