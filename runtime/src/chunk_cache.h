#pragma once
// The chunks of rows that are in memory, of a file that is read piece by piece: who asks the host for them, where what
// it brings lies, and which go when room is needed. Any thread may call anything at any time; the lock is held for
// lists of chunks alone, never while the host is called, bytes are copied or checked, or a row is decoded.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "latch.h"
#include "sightcell/format/reader.h"
#include "sightcell/sightcell.h"

namespace sightcell::runtime {

enum class chunk_presence : std::uint8_t {
  absent,     // nobody asked for it, or nothing came
  requested,  // it is on its way
  arriving,   // its bytes are being copied
  resident,
  damaged  // what came was not what the file's directory says: never asked for again
};

struct cached_chunk {
  std::uint64_t place = 0;     // in the room, where arriving or resident
  std::uint64_t last_use = 0;  // by the cache's clock; where requested, when that was
  std::uint32_t size = 0;      // bytes
  std::uint32_t ticket = 0;    // of the last request
  std::uint32_t pins = 0;      // how many are reading it
  chunk_presence presence = chunk_presence::absent;
};

struct cache_counts {
  std::uint64_t requests = 0;
  std::uint64_t delivered_bytes = 0;
  std::uint64_t evictions = 0;
  std::uint64_t resident_bytes = 0;
  std::uint64_t refused_deliveries = 0;  // unknown tickets, wrong sizes, damaged bytes, no room
};

class chunk_cache {
 public:
  // Requests that can be on their way at once. Of more than these the oldest is given up.
  static constexpr std::size_t most_requests = 64;

  // file, chunks (one for each chunk of the file), sorted (as many) and room are the caller's and must outlive the
  // cache. False where some chunk is larger than the room, or the file's bytes changed.
  [[nodiscard]] bool open(const format::reader& file, const sightcell_source& source, std::span<cached_chunk> chunks,
                          std::span<std::uint32_t> sorted, std::span<std::byte> room) noexcept;

  [[nodiscard]] bool is_open() const noexcept { return file_ != nullptr; }

  // Keeps a chunk that is resident where it is, and says where, until it is released. Any other: says how it is.
  [[nodiscard]] chunk_presence pin(std::uint32_t chunk, std::span<const std::byte>& bytes) noexcept;
  void release(std::uint32_t chunk) noexcept;

  // Asks the host for a chunk that is absent. It may come before this returns.
  void request(std::uint32_t chunk) noexcept;
  // Begins a list of chunks that are wanted together, of which none makes room for another. The first come first; those
  // for which there is no room beside the others are left out: false then.
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

  // What sightcell_db_deliver says.
  sightcell_status deliver(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept;

  [[nodiscard]] cache_counts counts() noexcept;

 private:
  static constexpr std::uint32_t no_chunk = 0xFFFFFFFFu;

  void request(std::uint32_t chunk, std::uint64_t stamp) noexcept;
  [[nodiscard]] std::uint32_t take_request(std::uint32_t ticket) noexcept;
  [[nodiscard]] bool make_room(std::uint32_t chunk) noexcept;
  void remove(std::size_t place_in_order) noexcept;

  latch latch_;
  const format::reader* file_ = nullptr;
  sightcell_source source_{};
  std::span<cached_chunk> chunks_;
  // Those that are arriving or resident, by their place in the room.
  std::span<std::uint32_t> sorted_;
  std::size_t sorted_count_ = 0;
  std::span<std::byte> room_;
  std::uint64_t clock_ = 0;
  std::uint32_t last_ticket_ = 0;
  // Oldest first from next_request_ on.
  std::array<std::uint32_t, most_requests> requests_{};
  std::size_t next_request_ = 0;
  cache_counts counts_;
};

}  // namespace sightcell::runtime
