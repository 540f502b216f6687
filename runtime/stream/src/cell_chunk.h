#pragma once
// A cell chunk, checked and decoded (docs/streaming.md, "Cell chunks"). Does not change.
#include <cstdint>
#include <span>

#include "front.h"

namespace sightcell::streaming {

struct listed_page {
  std::uint32_t page = 0;
  std::uint8_t share = 0;     // code of its weight
  std::uint8_t headings = 0;  // a bit per sector of 45 degrees
};

struct listed_image {
  std::uint32_t image = 0;
  std::uint8_t share = 0;
};

struct draw_run {
  std::uint32_t first = 0, count = 0;
};

struct chunk_cell {
  std::uint32_t number = 0;  // in the .pvs file
  float weight = 0.0f;       // steradians
  format::box box{};
  std::span<listed_page> pages;
  std::span<draw_run> runs;
  std::span<listed_image> images;
};

class cell_chunk {
 public:
  // file: with the right hash. out: receives the chunk, to be destroyed by destroy(), or null. Fails with MEMORY,
  // CORRUPT.
  static sightcell_status create(const front& scene, std::uint32_t chunk, std::span<const std::uint8_t> file,
                                 const sightcell_allocator& mem, cell_chunk** out) noexcept;
  static void destroy(const sightcell_allocator& mem, cell_chunk* chunk) noexcept;

  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  [[nodiscard]] std::span<const chunk_cell> cells() const noexcept { return cells_; }
  [[nodiscard]] std::uint64_t memory() const noexcept { return size_; }

  // Lists of chunks, of their owner.
  cell_chunk* next = nullptr;

 private:
  cell_chunk() = default;
  std::uint64_t carve(void* block, std::uint32_t cells, std::uint64_t pages, std::uint64_t runs,
                      std::uint64_t images) noexcept;
  void fill(const front& scene, class payload_reader& in) noexcept;

  std::uint32_t number_ = 0;
  std::uint64_t size_ = 0;
  std::span<chunk_cell> cells_;
  listed_page* pages_ = nullptr;
  draw_run* runs_ = nullptr;
  listed_image* images_ = nullptr;
};

// Returns the weight of a page or image in steradians: whole * 2^(-share / 8).
[[nodiscard]] float weight_of(float whole, std::uint8_t share) noexcept;

}  // namespace sightcell::streaming
