#pragma once
// One streamed scene: its front, the states of its files, and the cell chunks in memory. Shared by threads; all but the
// front is behind a latch.
#include <cstddef>
#include <cstdint>
#include <span>

#include "cell_chunk.h"
#include "front.h"
#include "latch.h"
#include "memory.h"
#include "sightcell/stream.h"

// In the global namespace, because the C API declares it.
struct sightcell_stream {
 public:
  static sightcell_status open(std::span<const std::uint8_t> front, std::uint64_t chunk_memory,
                               const sightcell_allocator& mem, sightcell_stream** out) noexcept;
  static void close(sightcell_stream* stream) noexcept;

  [[nodiscard]] const sightcell::streaming::front& front() const noexcept { return front_; }
  [[nodiscard]] const sightcell_allocator& allocator() const noexcept { return mem_; }

  [[nodiscard]] sightcell_status check(std::uint32_t file, std::span<const std::uint8_t> bytes) const noexcept;
  sightcell_status deliver(std::uint32_t file, std::span<const std::uint8_t> bytes) noexcept;
  sightcell_status set_state(std::uint32_t file, std::uint32_t state) noexcept;
  [[nodiscard]] std::uint32_t state(std::uint32_t file) const noexcept;
  // Returns how many it has written.
  std::size_t list_removable(std::span<std::uint32_t> dst) noexcept;

  void add(sightcell_stream_view& view) noexcept;
  void remove(sightcell_stream_view& view) noexcept;

  // ---- For views. While they hold the latch:
  [[nodiscard]] sightcell::runtime::latch& latch() const noexcept { return latch_; }
  [[nodiscard]] std::uint8_t state_of(std::uint32_t file) const noexcept { return states_[file]; }
  // Null if the chunk is not in memory.
  [[nodiscard]] sightcell::streaming::cell_chunk* chunk(std::uint32_t number) const noexcept { return chunks_[number]; }
  void pin(std::uint32_t chunk) noexcept { ++pins_[chunk]; }
  void unpin(std::uint32_t chunk) noexcept { --pins_[chunk]; }
  // A new time. What was needed at an earlier one is removed first.
  std::uint32_t advance() noexcept { return ++now_; }
  void touch(std::uint32_t file) noexcept { last_needed_[file] = now_; }
  void touch_files_of(const sightcell::streaming::chunk_cell& cell) noexcept;
  // An image has a version to draw, or never will.
  [[nodiscard]] bool is_settled(std::uint32_t image) const noexcept;

 private:
  explicit sightcell_stream(const sightcell_allocator& mem) noexcept : mem_(mem), front_(mem_) {}
  ~sightcell_stream() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  sightcell_status deliver_chunk(std::uint32_t number, std::span<const std::uint8_t> bytes) noexcept;
  sightcell::streaming::cell_chunk* take_least_recent(std::uint32_t kept) noexcept;
  void touch_image(std::uint32_t image) noexcept;

  const sightcell_allocator mem_;
  sightcell::streaming::front front_;
  std::uint64_t chunk_memory_ = 0;
  void* block_ = nullptr;
  std::uint64_t block_size_ = 0;

  mutable sightcell::runtime::latch latch_;
  std::uint8_t* states_ = nullptr;        // by file
  std::uint32_t* last_needed_ = nullptr;  // by file
  sightcell::streaming::cell_chunk** chunks_ = nullptr;
  std::uint32_t* pins_ = nullptr;  // by chunk
  std::uint64_t chunk_bytes_ = 0;  // of all in memory
  std::uint32_t now_ = 0;
  sightcell_stream_view* views_ = nullptr;
};
