#include "sightcell/format/residency_table.h"

#include <algorithm>
#include <new>

#include "bit_reader.h"
#include "checked_reader.h"
#include "code_table.h"
#include "residency_numbers.h"

namespace sightcell::format {

struct residency_codes {
  prefix_code runs, changes;
};

namespace {

bool take_number(const prefix_code& code, bit_reader& in, std::uint32_t& out) noexcept {
  unsigned length = 0;
  const std::uint32_t symbol = code.decode(in.peek(), length);
  if (symbol == prefix_code::no_symbol) return false;
  in.skip(length);
  out = base_of(symbol) + in.take(raw_bits_of(symbol));
  return !in.beyond_end();
}

}  // namespace

status residency_table::open(const reader& file, residency_table& out) noexcept {
  std::span<const std::byte> bytes;
  if (const status s = file.skipped_section(layout::section_residency, bytes); s != status::ok) return s;
  residency_table made;
  made.cells_ = file.cell_count();
  const checked_reader in(bytes);
  if (!in.read_u32(0, made.textures_) || !in.read_f32(4, made.pixels_per_radian_) || !in.read_f32(8, made.anisotropy_))
    return status::corrupt;
  if (made.textures_ > layout::max_textures) return status::limit;
  const float pixels = made.pixels_per_radian_;
  if (!(pixels > 0.0f) || !(pixels <= layout::max_pixels_per_radian) || !(made.anisotropy_ >= 1.0f) ||
      !(made.anisotropy_ <= layout::max_anisotropy)) {
    return status::corrupt;
  }
  std::span<const std::byte> left = bytes.subspan(layout::residency_head_size);
  packed_column columns[3];
  if (!take_columns(left, made.textures_, columns) || !take_columns(left, made.chunks(), {&made.ends_, 1}))
    return status::corrupt;
  made.image_ = columns[0];
  made.width_ = columns[1];
  made.height_ = columns[2];
  for (std::uint32_t i = 0; i < made.textures_; ++i) {
    const texture_record one = made.texture(i);
    if (i > 0 && one.image <= made.image_[i - 1]) return status::corrupt;
    for (const std::uint32_t side : {one.width, one.height}) {
      if (side == 0 || side > layout::max_texture_side) return status::corrupt;
    }
  }
  made.codes_ = left;
  symbol_lengths lengths{};
  for (int i = 0; i < 2; ++i) {
    if (!read_code_lengths(left, lengths)) return status::corrupt;
  }
  made.codes_ = made.codes_.first(made.codes_.size() - left.size());
  made.chunks_ = left;
  std::uint32_t end = 0;
  for (std::uint32_t chunk = 0; chunk < made.chunks(); ++chunk) {
    const std::uint32_t begin = end;
    end = made.ends_[chunk];
    if (end < begin) return status::corrupt;
  }
  if (std::uint64_t{end} + bit_reader::padding != left.size()) return status::corrupt;
  out = made;
  return status::ok;
}

texture_record residency_table::texture(std::uint32_t number) const noexcept {
  return {image_[number], width_[number], height_[number]};
}

std::size_t residency_table::codes_size() noexcept {
  return sizeof(residency_codes);
}

status residency_table::make_codes(std::span<std::byte> memory, const residency_codes*& out) const noexcept {
  out = nullptr;
  if (memory.size() < sizeof(residency_codes)) return status::capacity;
  auto* codes = new (memory.data()) residency_codes;
  std::span<const std::byte> left = codes_;
  if (!read_code(left, codes->runs) || !read_code(left, codes->changes)) return status::corrupt;
  out = codes;
  return status::ok;
}

// levels: receives those of the last of the cells.
status residency_table::decode_chunk(std::uint32_t chunk, std::uint32_t cells, const residency_codes& codes,
                                     std::span<std::uint8_t> levels) const noexcept {
  const std::uint32_t begin = chunk == 0 ? 0 : ends_[chunk - 1];
  const std::uint32_t end = ends_[chunk];
  if (begin > end || std::uint64_t{end} + bit_reader::padding > chunks_.size()) return status::corrupt;
  bit_reader in(chunks_.subspan(begin, end - begin + bit_reader::padding));
  const std::span<std::uint8_t> state = levels.first(textures_);
  std::fill(state.begin(), state.end(), state_at_begin);
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    for (std::uint32_t i = 0; i < textures_; ++i) {
      std::uint32_t run = 0;
      if (!take_number(codes.runs, in, run) || run > textures_ - i) return status::corrupt;
      i += run;
      if (i == textures_) break;
      std::uint32_t change = 0;
      if (!take_number(codes.changes, in, change) || !apply_change(change, coarsest_level(texture(i)), state[i]))
        return status::corrupt;
    }
  }
  const bool whole =
      cells == std::min(cells_ - chunk * layout::cells_per_residency_chunk, layout::cells_per_residency_chunk);
  if (whole && (in.place() + 7) / 8 != end - begin) return status::corrupt;
  for (std::uint8_t& one : state) one = level_of_state(one);
  return status::ok;
}

status residency_table::decode(std::uint32_t cell, const residency_codes* codes,
                               std::span<std::uint8_t> levels) const noexcept {
  if (cell >= cells_ || codes == nullptr) return status::argument;
  if (levels.size() < textures_) return status::capacity;
  const std::uint32_t chunk = cell / layout::cells_per_residency_chunk;
  return decode_chunk(chunk, cell % layout::cells_per_residency_chunk + 1, *codes, levels);
}

status residency_table::check(const residency_codes* codes, std::span<std::uint8_t> levels) const noexcept {
  if (codes == nullptr) return status::argument;
  if (levels.size() < textures_) return status::capacity;
  for (std::uint32_t chunk = 0; chunk < chunks(); ++chunk) {
    const std::uint32_t left = cells_ - chunk * layout::cells_per_residency_chunk;
    const status s = decode_chunk(chunk, std::min(left, layout::cells_per_residency_chunk), *codes, levels);
    if (s != status::ok) return s;
  }
  return status::ok;
}

}  // namespace sightcell::format
