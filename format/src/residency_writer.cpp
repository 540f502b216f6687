#include "sightcell/format/residency_writer.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "bit_reader.h"
#include "bit_sink.h"
#include "byte_sink.h"
#include "code_lengths.h"
#include "code_table_writer.h"
#include "last_section.h"
#include "memory_status.h"
#include "packed_columns_writer.h"
#include "prefix_code.h"
#include "residency_numbers.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"

namespace sightcell::format {
namespace {

// Codes for numbers of one kind, made from how often each was counted.
struct counted_code {
  symbol_counts counts{};
  symbol_lengths lengths{};
  std::array<std::uint32_t, symbol_count> codes{};

  void make() {
    lengths = best_lengths(counts, longest_code);
    prefix_code code;
    if (!code.assign(lengths)) return;
    code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned) { codes[symbol] = bits; });
  }
  void put(std::uint32_t number, bit_sink& bits) const {
    const number_symbol n = symbol_of(number);
    bits.put(codes[n.symbol], lengths[n.symbol]);
    bits.put(n.raw, n.raw_bits);
  }
};

class residency_encoder {
 public:
  residency_encoder(const residency_source& source, std::uint32_t cells)
      : source_(source), cells_(cells), levels_(source.textures.size()), state_(levels_.size()) {}

  // Appends the section. Two passes: the first one counts.
  status encode(std::vector<std::byte>& section) {
    status s = for_each_number([&](std::uint32_t run) { ++runs_.counts[symbol_of(run).symbol]; },
                               [&](std::uint32_t change) { ++changes_.counts[symbol_of(change).symbol]; }, [] {});
    if (s != status::ok) return s;
    runs_.make();
    changes_.make();
    std::vector<std::byte> chunks;
    std::vector<std::uint32_t> ends;
    bit_sink bits(chunks);
    s = for_each_number([&](std::uint32_t run) { runs_.put(run, bits); },
                        [&](std::uint32_t change) { changes_.put(change, bits); },
                        [&] {
                          bits.align();
                          ends.push_back(static_cast<std::uint32_t>(chunks.size()));
                        });
    if (s != status::ok) return s;
    if (chunks.size() > layout::max_chunk_size) return status::limit;
    byte_sink out(section);
    out.put_u32(static_cast<std::uint32_t>(source_.textures.size()));
    out.put_f32(source_.pixels_per_radian);
    out.put_f32(source_.anisotropy);
    std::vector<std::vector<std::uint32_t>> columns(3);
    for (const texture_record& one : source_.textures) {
      columns[0].push_back(one.image);
      columns[1].push_back(one.width);
      columns[2].push_back(one.height);
    }
    put_columns(columns, section);
    const std::vector<std::vector<std::uint32_t>> of_chunks{std::move(ends)};
    put_columns(of_chunks, section);
    put_code_lengths(runs_.lengths, section);
    put_code_lengths(changes_.lengths, section);
    out.put_bytes(chunks);
    section.insert(section.end(), bit_reader::padding, std::byte{0});
    return status::ok;
  }

 private:
  // Calls run and change for all numbers in the order of the file, end after each chunk.
  template <class Run, class Change, class End>
  status for_each_number(const Run& run, const Change& change, const End& end) {
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      if (cell % layout::cells_per_residency_chunk == 0) std::fill(state_.begin(), state_.end(), state_at_begin);
      if (const status s = source_.get(cell, levels_); s != status::ok) return s;
      std::uint32_t same = 0;
      for (std::size_t i = 0; i < levels_.size(); ++i) {
        if (levels_[i] > coarsest_level(source_.textures[i])) return status::argument;
        if (levels_[i] == level_of_state(state_[i])) {
          ++same;
          continue;
        }
        run(std::exchange(same, 0));
        change(change_to(levels_[i], state_[i]));
      }
      if (same > 0) run(same);
      if ((cell + 1) % layout::cells_per_residency_chunk == 0 || cell + 1 == cells_) end();
    }
    return status::ok;
  }

  const residency_source& source_;
  std::uint32_t cells_;
  std::vector<std::uint8_t> levels_, state_;
  counted_code runs_, changes_;
};

bool textures_are_valid(const std::vector<texture_record>& textures) {
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const texture_record& one = textures[i];
    if (i > 0 && one.image <= textures[i - 1].image) return false;
    if (one.width == 0 || one.height == 0 || std::max(one.width, one.height) > layout::max_texture_side) return false;
  }
  return true;
}

status put_checked(std::span<const std::byte> bytes, const residency_source* source, std::vector<std::byte>& out) {
  reader file;
  if (const status s = reader::open(bytes, file); s != status::ok) return s;
  if (source == nullptr) return with_front_section(file, bytes, layout::section_residency, std::nullopt, out);
  if (file.format_version() != layout::version) return status::version;
  if (source->textures.size() > layout::max_textures) return status::limit;
  if (!textures_are_valid(source->textures)) return status::argument;
  std::vector<std::byte> section;
  if (const status s = residency_encoder(*source, file.cell_count()).encode(section); s != status::ok) return s;
  std::vector<std::byte> made;
  const status s =
      with_front_section(file, bytes, layout::section_residency, std::span<const std::byte>(section), made);
  if (s != status::ok) return s;
  // The rules of the other numbers are those of the reader.
  reader again;
  residency_table table;
  if (reader::open(made, again) != status::ok || residency_table::open(again, table) != status::ok)
    return status::argument;
  out = std::move(made);
  return status::ok;
}

}  // namespace

status put_residency(std::span<const std::byte> file, const residency_source& source, std::vector<std::byte>& out) {
  return or_memory([&] { return put_checked(file, &source, out); });
}

status remove_residency(std::span<const std::byte> file, std::vector<std::byte>& out) {
  return or_memory([&] { return put_checked(file, nullptr, out); });
}

}  // namespace sightcell::format
