#include "row_decoder.h"

#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Reads runs from a stream of (gap, length - 1). The gap of the first run counts from polygon 0; later ones omit the
// one polygon that must be between two runs, so that touching runs cannot be encoded.
class run_stream {
 public:
  run_stream(varint_cursor bytes, std::uint32_t count, std::uint32_t polygon_count) noexcept
      : bytes_(bytes), left_(count), polygon_count_(polygon_count) {}

  // Moves to the next run. False on bytes that are not a run inside polygon_count, and if bytes are left after the last
  // run.
  [[nodiscard]] bool next() noexcept {
    if (left_ == 0) {
      done_ = true;
      return bytes_.at_end();
    }
    --left_;
    std::uint32_t gap = 0;
    std::uint32_t more = 0;
    if (!bytes_.read(gap) || !bytes_.read(more)) return false;
    first_ = end_ + gap + (started_ ? 1u : 0u);
    end_ = first_ + more + 1u;
    started_ = true;
    return end_ <= polygon_count_;
  }

  [[nodiscard]] bool done() const noexcept { return done_; }
  [[nodiscard]] std::uint64_t first() const noexcept { return first_; }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }

 private:
  varint_cursor bytes_;
  std::uint32_t left_;
  std::uint64_t polygon_count_;
  std::uint64_t first_ = 0;
  std::uint64_t end_ = 0;
  bool started_ = false;
  bool done_ = false;
};

// Collects ascending pieces into runs; pieces that touch become one.
class run_sink {
 public:
  explicit run_sink(std::span<run> out) noexcept : out_(out) {}

  // False if the piece begins before the last one ended, or there is no more room.
  [[nodiscard]] bool put(std::uint64_t first, std::uint64_t end) noexcept {
    if (first >= end) return true;
    if (count_ > 0 && first <= end_) {
      if (first < end_) return false;
      out_[count_ - 1].count += static_cast<std::uint32_t>(end - first);
    } else {
      if (count_ == out_.size()) return false;
      out_[count_++] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
    }
    end_ = end;
    return true;
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  std::span<run> out_;
  std::size_t count_ = 0;
  std::uint64_t end_ = 0;
};

// Merges what is kept of the reference with what is added.
class delta_merger {
 public:
  delta_merger(run_stream added, std::span<run> out) noexcept : added_(added), sink_(out) {}

  [[nodiscard]] bool start() noexcept { return added_.next(); }

  [[nodiscard]] bool keep(std::uint64_t first, std::uint64_t end) noexcept {
    if (first >= end) return true;
    while (!added_.done() && added_.first() < first) {
      if (!put_added()) return false;
    }
    return sink_.put(first, end);
  }

  [[nodiscard]] bool finish() noexcept {
    while (!added_.done()) {
      if (!put_added()) return false;
    }
    return true;
  }

  [[nodiscard]] std::size_t count() const noexcept { return sink_.count(); }

 private:
  [[nodiscard]] bool put_added() noexcept { return sink_.put(added_.first(), added_.end()) && added_.next(); }

  run_stream added_;
  run_sink sink_;
};

bool apply_difference(const row_header& row, std::uint32_t polygon_count, std::span<const run> reference,
                      delta_merger& merger) noexcept {
  run_stream removed(row.first, row.first_count, polygon_count);
  if (!removed.next() || !merger.start()) return false;
  for (const run& r : reference) {
    std::uint64_t place = r.first;
    const std::uint64_t end = place + r.count;
    while (!removed.done() && removed.first() < end) {
      if (removed.first() < place || removed.end() > end) return false;  // removes a number that is not a member
      if (!merger.keep(place, removed.first())) return false;
      place = removed.end();
      if (!removed.next()) return false;
    }
    if (!merger.keep(place, end)) return false;
  }
  return removed.done() && merger.finish();
}

}  // namespace

bool read_row_header(std::span<const std::byte> row, row_header& out) noexcept {
  varint_cursor bytes(row);
  std::uint32_t head = 0;
  if (!bytes.read(head)) return false;
  out = row_header{};
  out.delta = (head & 1u) != 0;
  out.first_count = head >> 1;
  if (!out.delta) {
    out.first = bytes;
    return true;
  }
  std::uint32_t first_size = 0;
  if (!bytes.read(out.reference) || !bytes.read(out.second_count) || !bytes.read(first_size)) return false;
  if (out.reference >= layout::cells_per_block || !bytes.split(first_size, out.first)) return false;
  out.second = bytes;
  return true;
}

status decode_own_row(row_header row, std::uint32_t polygon_count, std::span<run> out, std::size_t& count) noexcept {
  count = 0;
  run_stream own(row.first, row.first_count, polygon_count);
  run_sink sink(out);
  for (;;) {
    if (!own.next()) return status::corrupt;
    if (own.done()) break;
    if (!sink.put(own.first(), own.end())) return status::corrupt;
  }
  count = sink.count();
  return status::ok;
}

status decode_delta_row(row_header row, std::uint32_t polygon_count, std::span<const run> reference, std::span<run> out,
                        std::size_t& count) noexcept {
  count = 0;
  delta_merger merger(run_stream(row.second, row.second_count, polygon_count), out);
  if (!apply_difference(row, polygon_count, reference, merger)) return status::corrupt;
  count = merger.count();
  return status::ok;
}

}  // namespace sightcell::format
