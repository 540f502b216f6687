#pragma once
// The chunks of a paged file that are in memory: requests them from the host, stores what is delivered, and removes the
// least recently used ones. Any thread may call any function at any time. The lock is held only for the lists of
// chunks, never while the host is called, bytes are copied or checked, or a row is decoded.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "latch.h"
#include "sightcell/format/reader.h"
#include "sightcell/sightcell.h"

namespace sightcell::runtime {

enum class chunk_presence : std::uint8_t {
  absent,     // not requested, or nothing was delivered
  requested,  // requested, not delivered yet
  arriving,   // its bytes are being copied
  resident,
  damaged  // the delivered bytes do not match the directory of the file: never requested again
};

struct cached_chunk {
  std::uint64_t offset = 0;    // offset in the memory of the cache, where arriving or resident
  std::uint64_t last_use = 0;  // by the clock of the cache; where requested, the time of the request
  std::uint32_t size = 0;      // bytes
  std::uint32_t ticket = 0;    // of the last request
  std::uint32_t pins = 0;      // number of readers
  chunk_presence presence = chunk_presence::absent;
};

struct cache_counts {
  std::uint64_t requests = 0;
  std::uint64_t delivered_bytes = 0;
  std::uint64_t evictions = 0;
  std::uint64_t resident_bytes = 0;
  std::uint64_t refused_deliveries = 0;  // unknown tickets, wrong sizes, damaged bytes, no memory
};

class chunk_cache {
 public:
  // Requests that can be open at once. Beyond this the oldest one is given up.
  static constexpr std::size_t most_requests = 64;

  // file, chunks and sorted (both with one element per chunk of the file) and room belong to the caller and must
  // outlive the cache. False if a chunk is larger than room, or the bytes of the file changed.
  [[nodiscard]] bool open(const format::reader& file, const sightcell_source& source, std::span<cached_chunk> chunks,
                          std::span<std::uint32_t> sorted, std::span<std::byte> room) noexcept;

  [[nodiscard]] bool is_open() const noexcept { return file_ != nullptr; }

  // Returns the state of a chunk. A resident chunk stays where it is until release; bytes receives its bytes.
  [[nodiscard]] chunk_presence pin(std::uint32_t chunk, std::span<const std::byte>& bytes) noexcept;
  void release(std::uint32_t chunk) noexcept;

  // Requests an absent chunk from the host, which may deliver it before this returns.
  void request(std::uint32_t chunk) noexcept;
  // A list of chunks that are wanted together: none of them removes another one. add returns false for a chunk for
  // which there is no memory beside those that were added before.
  class wish_list {
   public:
    explicit wish_list(chunk_cache& cache) noexcept;
    bool add(std::uint32_t chunk) noexcept;

   private:
    chunk_cache& cache_;
    std::uint64_t stamp_;
    std::uint64_t bytes_ = 0;
    std::size_t requests_ = 0;
  };

  // Implements sightcell_db_deliver.
  sightcell_status deliver(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept;

  [[nodiscard]] cache_counts counts() noexcept;

 private:
  static constexpr std::uint32_t no_chunk = 0xFFFFFFFFu;

  void request(std::uint32_t chunk, std::uint64_t stamp) noexcept;
  [[nodiscard]] std::uint32_t take_request(std::uint32_t ticket) noexcept;
  [[nodiscard]] bool make_room(std::uint32_t chunk) noexcept;
  void remove(std::size_t index) noexcept;

  latch latch_;
  const format::reader* file_ = nullptr;
  sightcell_source source_{};
  std::span<cached_chunk> chunks_;
  // The chunks that are arriving or resident, sorted by their offset.
  std::span<std::uint32_t> sorted_;
  std::size_t sorted_count_ = 0;
  std::span<std::byte> room_;
  std::uint64_t clock_ = 0;
  std::uint32_t last_ticket_ = 0;
  // A ring buffer: the oldest is at next_request_.
  std::array<std::uint32_t, most_requests> requests_{};
  std::size_t next_request_ = 0;
  cache_counts counts_;
};

}  // namespace sightcell::runtime
