#include "row_chunk.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Decodes a list, with the padding for apply_rank_difference. Empty if it is invalid, or longer than the room for the
// longest list and its padding.
std::span<const std::uint32_t> decode_list(const run_code& code, bit_reader& in, std::uint32_t count,
                                           std::uint32_t limit, std::span<std::uint32_t> room) noexcept {
  if (!code.decode(in, count, limit, room.first(room.size() - list_padding))) return {};
  const auto borders = 2 * std::size_t{count};
  std::fill_n(room.begin() + static_cast<std::ptrdiff_t>(borders), list_padding, no_border);
  return room.first(borders + list_padding);
}

}  // namespace

bool row_chunk::open(std::span<const std::byte> bytes, std::uint32_t rows) noexcept {
  *this = row_chunk{};
  if (bytes.size() < bit_reader::padding || rows == 0 || rows > layout::cells_per_block) return false;
  bit_reader in(bytes);
  const std::uint32_t bits = in.take(8);
  if (bits > 32) return false;
  const std::uint64_t table_bytes = 1 + (std::uint64_t{bits} * rows + 7) / 8;
  if (table_bytes > bytes.size() - bit_reader::padding) return false;
  table_ = in;
  table_bits_ = bits;
  rows_ = rows;
  bytes_ = bytes.subspan(static_cast<std::size_t>(table_bytes));
  size_ = bytes_.size() - bit_reader::padding;
  return true;
}

std::uint64_t row_chunk::begin_of(std::uint32_t place) const noexcept {
  if (place >= rows_) return size_;
  bit_reader in = table_;
  in.seek(table_.place() + std::uint64_t{place} * table_bits_);
  return in.take(table_bits_);
}

bool row_chunk::head(std::uint32_t place, row_head& out) const noexcept {
  if (place >= rows_) return false;
  bit_reader in(bytes_);
  in.seek(8 * begin_of(place));
  row_head h;
  h.delta = in.take(1) != 0;
  if (h.delta) h.reference = in.take(6);
  h.first_count = take_count(in);
  if (h.delta) h.second_count = take_count(in);
  if (in.beyond_end()) return false;
  h.lists = in;
  out = h;
  return true;
}

// A row of depth d has a chain of d references: the last one is decoded first, then each difference from one half of
// the scratch into the other.
status row_chunk::decode(std::uint32_t place, const row_codes& codes, const row_bounds& bounds,
                         std::span<std::uint32_t> scratch, std::span<const std::uint32_t>& borders,
                         std::uint64_t& end) const noexcept {
  borders = {};
  if (scratch.size() < bounds.scratch_room()) return status::capacity;
  std::array<row_head, layout::max_reference_depth + 1> chain;
  std::uint32_t depth = 0;
  for (std::uint32_t at = place;; ++depth) {
    if (!head(at, chain[depth])) return status::corrupt;
    if (!chain[depth].delta) break;
    if (depth == layout::max_reference_depth) return status::corrupt;
    at = chain[depth].reference;
  }
  if (chain[depth].first_count > bounds.runs) return status::corrupt;

  std::span<std::uint32_t> set = scratch.first(bounds.set_room());
  std::span<std::uint32_t> next = scratch.subspan(bounds.set_room(), bounds.set_room());
  const auto removed_room = scratch.subspan(2 * bounds.set_room(), bounds.list_room());
  const auto added_room = scratch.subspan(2 * bounds.set_room() + bounds.list_room(), bounds.list_room());
  row_head& root = chain[depth];
  if (!codes.own.decode(root.lists, root.first_count, bounds.limit, set)) return status::corrupt;
  std::size_t count = 2 * std::size_t{root.first_count};
  while (depth > 0) {
    row_head& row = chain[--depth];
    const auto removed = decode_list(codes.removed, row.lists, row.first_count, bounds.limit, removed_room);
    const auto added = decode_list(codes.added, row.lists, row.second_count, bounds.limit, added_room);
    if (!apply_rank_difference(set.first(count), removed, added, bounds.limit, next, count)) return status::corrupt;
    if (count > 2 * std::size_t{bounds.runs}) return status::corrupt;
    std::swap(set, next);
  }
  borders = set.first(count);
  end = (chain[0].lists.place() + 7) / 8;
  return status::ok;
}

}  // namespace sightcell::format
