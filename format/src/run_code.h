#pragma once
// Lists of runs <- bits (SPEC.md, "Rows"): for each run the code of its gap, the code of its length - 1, then the
// raw bits of both. One look into a table gives both symbols of almost every run. run_encoder.h is the way back.
#include <array>
#include <cstdint>
#include <span>

#include "bit_reader.h"
#include "prefix_code.h"

namespace sightcell::format {

class run_code {
 public:
  // Both codes; false where one of them is none (prefix_code::assign). About 36 KiB, all inside the object.
  [[nodiscard]] bool assign(std::span<const std::uint8_t> gap_lengths,
                            std::span<const std::uint8_t> more_lengths) noexcept;

  // The next `count` runs of `in`, ascending, disjoint and not touching, all below limit, as their borders: out[2 i] is
  // the first number of run i, out[2 i + 1] the one behind its last. False when the bits are none, reach beyond limit
  // or the end of in, or out is too small; out holds anything then.
  [[nodiscard]] bool decode(bit_reader& in, std::uint32_t count, std::uint32_t limit,
                            std::span<std::uint32_t> out) const noexcept;

 private:
  static constexpr unsigned table_bits = 12;
  // What the lowest bits of a list mean. A number is head << raw_bits, and the raw bits. bits 0: the codes are longer
  // than the table sees, or there are more raw bits than one peek gives.
  struct alignas(8) entry {
    std::uint8_t bits = 0;       // all of them
    std::uint8_t code_bits = 0;  // of both codes
    std::uint8_t gap_bits = 0;   // raw
    std::uint8_t more_bits = 0;  // raw
    std::uint8_t gap_head = 0;
    std::uint8_t more_head = 0;
  };

  void fill_table() noexcept;
  [[nodiscard]] bool decode_long(bit_buffer& held, std::uint32_t& gap, std::uint32_t& more) const noexcept;

  prefix_code gap_, more_;
  std::array<entry, std::size_t{1} << table_bits> table_{};
};

}  // namespace sightcell::format
