#include "chunk_cache.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace sightcell::runtime {

bool chunk_cache::open(const format::reader& file, const sightcell_source& source, std::span<cached_chunk> chunks,
                       std::span<std::uint32_t> sorted, std::span<std::byte> room) noexcept {
  file_ = &file;
  source_ = source;
  chunks_ = chunks;
  sorted_ = sorted;
  room_ = room;
  requests_.fill(no_chunk);
  for (std::uint32_t chunk = 0; chunk < chunks.size(); ++chunk) {
    std::uint64_t offset = 0;
    if (file.chunk_place(chunk, offset, chunks[chunk].size) != format::status::ok) return false;
    if (chunks[chunk].size > room.size()) return false;
  }
  return true;
}

chunk_presence chunk_cache::pin(std::uint32_t chunk, std::span<const std::byte>& bytes) noexcept {
  const latch_guard guard(latch_);
  cached_chunk& c = chunks_[chunk];
  if (c.presence != chunk_presence::resident) return c.presence;
  c.last_use = ++clock_;
  ++c.pins;
  bytes = room_.subspan(static_cast<std::size_t>(c.offset), c.size);
  return chunk_presence::resident;
}

void chunk_cache::release(std::uint32_t chunk) noexcept {
  const latch_guard guard(latch_);
  --chunks_[chunk].pins;
}

void chunk_cache::request(std::uint32_t chunk) noexcept {
  latch_.lock();
  const std::uint64_t stamp = ++clock_;
  latch_.unlock();
  request(chunk, stamp);
}

void chunk_cache::request(std::uint32_t chunk, std::uint64_t stamp) noexcept {
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  if (file_->chunk_place(chunk, offset, size) != format::status::ok) return;
  std::uint32_t ticket = 0;
  {
    const latch_guard guard(latch_);
    cached_chunk& c = chunks_[chunk];
    if (c.presence != chunk_presence::absent) return;
    ticket = ++last_ticket_;
    c.presence = chunk_presence::requested;
    c.ticket = ticket;
    c.last_use = stamp;
    std::uint32_t& oldest = requests_[next_request_];
    if (oldest != no_chunk && chunks_[oldest].presence == chunk_presence::requested) {
      chunks_[oldest].presence = chunk_presence::absent;
    }
    oldest = chunk;
    next_request_ = (next_request_ + 1) % most_requests;
    ++counts_.requests;
  }
  if (source_.request(source_.user, offset, size, ticket) == SIGHTCELL_OK) return;
  const latch_guard guard(latch_);
  static_cast<void>(take_request(ticket));
}

// Finds the chunk that waits for a ticket and makes it absent; no_chunk if there is none.
std::uint32_t chunk_cache::take_request(std::uint32_t ticket) noexcept {
  for (std::uint32_t& chunk : requests_) {
    if (chunk == no_chunk) continue;
    cached_chunk& c = chunks_[chunk];
    if (c.ticket != ticket || c.presence != chunk_presence::requested) continue;
    c.presence = chunk_presence::absent;
    return std::exchange(chunk, no_chunk);
  }
  return no_chunk;
}

void chunk_cache::remove(std::size_t index) noexcept {
  counts_.resident_bytes -= chunks_[sorted_[index]].size;
  const auto order = sorted_.first(sorted_count_);
  std::copy(order.begin() + static_cast<std::ptrdiff_t>(index) + 1, order.end(),
            order.begin() + static_cast<std::ptrdiff_t>(index));
  --sorted_count_;
}

// Finds a range of the memory for a chunk and assigns it. Of the ranges that are large enough it takes the one whose
// most recently used chunk was used longest ago, then the one with the fewest chunks. No chunk in it may be in use, or
// wanted more recently than the new one.
bool chunk_cache::make_room(std::uint32_t chunk) noexcept {
  cached_chunk& wanted = chunks_[chunk];
  const auto begin_of = [this](std::size_t i) { return i < sorted_count_ ? chunks_[sorted_[i]].offset : room_.size(); };
  const auto end_of = [this](std::size_t i) {
    const cached_chunk& c = chunks_[sorted_[i]];
    return c.offset + c.size;
  };
  std::uint64_t best_age = ~std::uint64_t{0};
  std::size_t best_first = 0;
  std::size_t best_count = 0;
  for (std::size_t first = 0; first <= sorted_count_; ++first) {
    const std::uint64_t from = first == 0 ? 0 : end_of(first - 1);
    std::uint64_t youngest = 0;
    for (std::size_t next = first;; ++next) {
      if (begin_of(next) - from >= wanted.size) {
        if (youngest < best_age || (youngest == best_age && next - first < best_count)) {
          best_age = youngest;
          best_first = first;
          best_count = next - first;
        }
        break;
      }
      if (next == sorted_count_) break;
      const cached_chunk& c = chunks_[sorted_[next]];
      if (c.pins > 0 || c.presence != chunk_presence::resident || c.last_use >= wanted.last_use) break;
      youngest = std::max(youngest, c.last_use);
    }
  }
  if (best_age == ~std::uint64_t{0}) return false;
  for (; best_count > 0; --best_count) {
    chunks_[sorted_[best_first]].presence = chunk_presence::absent;
    remove(best_first);
    ++counts_.evictions;
  }
  wanted.offset = best_first == 0 ? 0 : end_of(best_first - 1);
  wanted.presence = chunk_presence::arriving;
  const auto order = sorted_.first(sorted_count_ + 1);
  std::copy_backward(order.begin() + static_cast<std::ptrdiff_t>(best_first), order.end() - 1, order.end());
  order[best_first] = chunk;
  ++sorted_count_;
  counts_.resident_bytes += wanted.size;
  return true;
}

sightcell_status chunk_cache::deliver(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept {
  std::uint32_t chunk = no_chunk;
  std::span<std::byte> target;
  {
    const latch_guard guard(latch_);
    chunk = take_request(ticket);
    const bool failed = bytes == nullptr;
    if (chunk != no_chunk && failed) return SIGHTCELL_OK;
    ++counts_.refused_deliveries;  // undone below
    if (chunk == no_chunk) return SIGHTCELL_ERR_STALE;
    if (size != chunks_[chunk].size)
      return size < chunks_[chunk].size ? SIGHTCELL_ERR_TRUNCATED : SIGHTCELL_ERR_CORRUPT;
    if (!make_room(chunk)) return SIGHTCELL_ERR_CAPACITY;
    --counts_.refused_deliveries;
    target = room_.subspan(static_cast<std::size_t>(chunks_[chunk].offset), size);
  }
  // The copy is checked, because the caller's bytes may change.
  std::memcpy(target.data(), bytes, size);
  const bool good = file_->check_chunk(chunk, target) == format::status::ok;
  const latch_guard guard(latch_);
  if (good) {
    chunks_[chunk].presence = chunk_presence::resident;
    counts_.delivered_bytes += size;
    return SIGHTCELL_OK;
  }
  chunks_[chunk].presence = chunk_presence::damaged;
  for (std::size_t i = 0; i < sorted_count_; ++i) {
    if (sorted_[i] == chunk) remove(i);
  }
  ++counts_.refused_deliveries;
  return SIGHTCELL_ERR_CHECKSUM;
}

cache_counts chunk_cache::counts() noexcept {
  const latch_guard guard(latch_);
  return counts_;
}

chunk_cache::wish_list::wish_list(chunk_cache& cache) noexcept : cache_(cache) {
  const latch_guard guard(cache.latch_);
  stamp_ = ++cache.clock_;
}

bool chunk_cache::wish_list::add(std::uint32_t chunk) noexcept {
  {
    const latch_guard guard(cache_.latch_);
    cached_chunk& c = cache_.chunks_[chunk];
    if (c.size > cache_.room_.size() - bytes_) return false;
    if (c.presence == chunk_presence::damaged || c.last_use == stamp_) return true;
    if (c.presence == chunk_presence::absent && requests_ == most_requests / 2) return false;
    bytes_ += c.size;
    if (c.presence != chunk_presence::absent) {
      c.last_use = std::max(c.last_use, stamp_);
      return true;
    }
    ++requests_;
  }
  cache_.request(chunk, stamp_);
  return true;
}

}  // namespace sightcell::runtime
