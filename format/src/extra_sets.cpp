#include "sightcell/format/extra_sets.h"

#include <algorithm>
#include <memory>
#include <new>

#include "certificate_columns.h"
#include "code_table.h"
#include "record_rules.h"
#include "row_chunk.h"

namespace sightcell::format {

status extra_sets::open(std::span<const std::byte> bytes, const shape& of, extra_sets& out) noexcept {
  extra_sets made;
  made.shape_ = of;
  std::span<const std::byte> left = bytes;
  if (!take_columns(left, of.count, made.certificate_) || !take_columns(left, made.chunks(), {&made.ends_, 1})) {
    return status::corrupt;
  }
  certificate_record proof;
  for (std::uint32_t set = 0; set < of.count; ++set) {
    if (const status s = made.certificate(set, 0, proof); s != status::ok) return s;
  }
  made.codes_ = left;
  symbol_lengths lengths{};
  for (int i = 0; i < 6; ++i) {
    if (!read_code_lengths(left, lengths)) return status::corrupt;
  }
  made.codes_ = made.codes_.first(made.codes_.size() - left.size());
  made.rows_ = left;
  std::uint32_t end = 0;
  for (std::uint32_t chunk = 0; chunk < made.chunks(); ++chunk) {
    const std::uint32_t begin = end;
    end = made.ends_[chunk];
    if (end < begin) return status::corrupt;
  }
  if (end != made.rows_.size()) return status::corrupt;
  // A run takes two codes of a bit or more, so a small section cannot ask for large buffers.
  const std::uint64_t most_runs = 4 * static_cast<std::uint64_t>(made.rows_.size());
  if (of.run_bound > most_runs || of.run_bound > of.polygons || of.list_bound > most_runs) return status::corrupt;
  out = made;
  return status::ok;
}

status extra_sets::certificate(std::uint32_t set, std::uint32_t cell, certificate_record& out) const noexcept {
  if (set >= shape_.count) return status::argument;
  const certificate_record c = certificate_of(certificate_, set, cell);
  if (!certificate_is_valid(c)) return status::corrupt;
  out = c;
  return status::ok;
}

std::size_t extra_sets::scratch_size() const noexcept {
  return row_bounds{shape_.polygons, shape_.run_bound, shape_.list_bound}.scratch_room() * sizeof(std::uint32_t);
}

status extra_sets::make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept {
  out = nullptr;
  if (memory.size() < sizeof(row_codes)) return status::capacity;
  auto* codes = new (memory.data()) row_codes;
  std::span<const std::byte> left = codes_;
  for (run_code* kind : {&codes->own, &codes->removed, &codes->added}) {
    symbol_lengths gap{};
    symbol_lengths more{};
    if (!read_code_lengths(left, gap) || !read_code_lengths(left, more) || !kind->assign(gap, more)) {
      return status::corrupt;
    }
  }
  out = codes;
  return status::ok;
}

status extra_sets::decode(std::uint32_t set, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                          std::size_t& count) const noexcept {
  count = 0;
  if (set >= shape_.count || codes == nullptr) return status::argument;
  if (out.size() < shape_.run_bound || scratch.size() < scratch_size()) return status::capacity;
  const std::uint32_t chunk = set / layout::cells_per_block;
  const std::uint32_t first = chunk * layout::cells_per_block;
  const std::uint32_t begin = chunk == 0 ? 0 : ends_[chunk - 1];
  const std::uint32_t end = ends_[chunk];
  if (begin > end || end > rows_.size()) return status::corrupt;
  row_chunk rows;
  if (!rows.open(rows_.subspan(begin, end - begin), std::min(shape_.count - first, layout::cells_per_block))) {
    return status::corrupt;
  }
  const std::size_t numbers = scratch.size() / sizeof(std::uint32_t);
  auto* room = reinterpret_cast<std::uint32_t*>(scratch.data());
  std::uninitialized_default_construct_n(room, numbers);
  std::span<const std::uint32_t> borders;
  std::uint64_t row_end = 0;
  const status s = rows.decode(set - first, *codes, {shape_.polygons, shape_.run_bound, shape_.list_bound},
                               {room, numbers}, borders, row_end);
  if (s != status::ok) return s;
  count = borders.size() / 2;
  for (std::size_t i = 0; i < count; ++i) out[i] = {borders[2 * i], borders[2 * i + 1] - borders[2 * i]};
  return status::ok;
}

status extra_sets::check(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept {
  std::size_t most = 0;
  for (std::uint32_t set = 0; set < shape_.count; ++set) {
    std::size_t count = 0;
    if (const status s = decode(set, codes, out, scratch, count); s != status::ok) return s;
    most = std::max(most, count);
  }
  return most == shape_.run_bound ? status::ok : status::corrupt;
}

}  // namespace sightcell::format
