#include "run_code.h"

namespace sightcell::format {
namespace {

std::uint32_t low_bits(std::uint64_t bits, unsigned count) noexcept {
  return static_cast<std::uint32_t>(bits & ((std::uint64_t{1} << count) - 1));
}

}  // namespace

bool run_code::assign(std::span<const std::uint8_t> gap_lengths, std::span<const std::uint8_t> more_lengths) noexcept {
  const bool good = gap_.assign(gap_lengths) && more_.assign(more_lengths);
  if (!good) *this = run_code{};
  fill_table();
  return good;
}

void run_code::fill_table() noexcept {
  table_.fill(entry());
  gap_.for_each([&](std::uint32_t gap, std::uint32_t gap_code, unsigned gap_length) {
    more_.for_each([&](std::uint32_t more, std::uint32_t more_code, unsigned more_length) {
      const unsigned code_bits = gap_length + more_length;
      const unsigned bits = code_bits + raw_bits_of(gap) + raw_bits_of(more);
      if (code_bits > table_bits || bits > bit_reader::peek_bits) return;
      const entry e(bits, code_bits, gap, more);
      for (std::size_t at = gap_code | more_code << gap_length; at < table_.size(); at += std::size_t{1} << code_bits) {
        table_[at] = e;
      }
    });
  });
}

bool run_code::decode_long(bit_buffer& held, std::uint32_t& gap, std::uint32_t& more) const noexcept {
  unsigned length = 0;
  const std::uint32_t gap_symbol = gap_.decode(held.bits(), length);
  if (gap_symbol == prefix_code::no_symbol) return false;
  held.skip(length);
  const std::uint32_t more_symbol = more_.decode(held.bits(), length);
  if (more_symbol == prefix_code::no_symbol) return false;
  held.skip(length);
  held.fill();
  gap = base_of(gap_symbol) + low_bits(held.bits(), raw_bits_of(gap_symbol));
  held.skip(raw_bits_of(gap_symbol));
  held.fill();
  more = base_of(more_symbol) + low_bits(held.bits(), raw_bits_of(more_symbol));
  held.skip(raw_bits_of(more_symbol));
  return true;
}

// The bits of a list are in a word that is filled for every two runs. The speed is limited by the path from one table
// lookup to the next, and filling is the longest part of it. If two runs have more bits than the word, which is rare,
// it is filled once more.
bool run_code::decode(bit_reader& in, std::uint32_t count, std::uint32_t limit,
                      std::span<std::uint32_t> out) const noexcept {
  if (count > out.size() / 2) return false;
  bit_buffer held(in);
  std::uint64_t next = 0;  // the lowest number with which the next run may begin
  std::uint32_t i = 0;
  // A template, so that each call has its own copy, which compilers inline. Else the module for pages, which is linked
  // for size, calls one function for each run and keeps what it holds in memory.
  const auto one = [&]<int Call>() noexcept {
    std::uint64_t bits = held.bits();
    entry e = table_[low_bits(bits, table_bits)];
    std::uint32_t gap = 0;
    std::uint32_t more = 0;
    if (e.bits() > held.left()) [[unlikely]] {
      held.fill();
      bits = held.bits();
      e = table_[low_bits(bits, table_bits)];
    }
    if (e.bits() != 0) [[likely]] {
      held.skip(e.bits());
      bits >>= e.code_bits();
      gap = (e.gap_head() << e.gap_bits()) | low_bits(bits, e.gap_bits());
      more = (e.more_head() << e.more_bits()) | low_bits(bits >> e.gap_bits(), e.more_bits());
    } else {
      held.fill();
      if (!decode_long(held, gap, more)) return false;
    }
    const std::uint64_t first = next + gap;
    next = first + more + 2;
    out[2 * std::size_t{i}] = static_cast<std::uint32_t>(first);
    out[2 * std::size_t{i} + 1] = static_cast<std::uint32_t>(next - 1);
    ++i;
    return next <= std::uint64_t{limit} + 1;
  };
  while (count - i >= 2) {
    held.fill();
    if (!one.template operator()<0>() || !one.template operator()<1>()) return false;
  }
  while (i < count) {
    held.fill();
    if (!one.template operator()<2>()) return false;
  }
  in.seek(held.place());
  return !in.beyond_end();
}

}  // namespace sightcell::format
