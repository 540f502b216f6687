#pragma once
// The importance section (SPEC.md, "Importance"): a class for each polygon of a set, by its share of the view from the
// cell. The counterpart for writing is importance_writer.h.
//
//   importance_classes importance;
//   if (status s = file.importance(importance); s != status::ok) return s;   // argument: the file has none
//   // row[0 .. runs): from reader::decode_row; polygons: the sum of their counts
//   status s = importance.decode(cell, std::span(classes).first(polygons));   // one per polygon, in stored order
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/chunk_borders.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Classes are 0 .. 15, the most important first. Polygons of the last one are tiny, or their importance is unknown.
inline constexpr std::uint32_t importance_class_count = 16;
inline constexpr std::uint8_t least_important = importance_class_count - 1;

// Returns the solid angle that represents a class, in sr: its geometric middle, pi / 4^k. The last class,
// which has all smaller solid angles, counts as class 11.
[[nodiscard]] constexpr float solid_angle_of_class(std::uint8_t one) noexcept {
  constexpr std::uint8_t first_unmeasured = 11;
  float angle = 3.14159265f;
  for (std::uint8_t k = 0; k < one && k < first_unmeasured; ++k) angle /= 4.0f;
  return angle;
}

// A view of one section, about 9 KiB; valid as long as the bytes are. Safe for hostile bytes. No exceptions, no
// allocation; const functions may run on any number of threads at once.
class importance_classes {
 public:
  // Bits of the longest code.
  static constexpr unsigned longest_code = 8;

  // The section of a file without cells.
  importance_classes() noexcept = default;

  // Opens a section. bytes: the section and nothing after it. chunks: of the file. out: set only on ok. checksum:
  // directory or codes are damaged; corrupt: invalid codes, or they do not fill the bytes. O(chunks).
  static status open(std::span<const std::byte> bytes, const chunk_borders& chunks, importance_classes& out) noexcept;

  // As reader::check_chunk, for the classes of a chunk. Reads all of it: remember the result.
  status check_chunk(std::uint32_t chunk) const noexcept;

  // Returns the class of each polygon of a cell's set, in stored order. out: one element per polygon. Checks no
  // checksum: call check_chunk once before. argument: no such cell; corrupt: the bits are not this number of classes,
  // out is undefined. O(polygons of the cell).
  status decode(std::uint32_t cell, std::span<std::uint8_t> out) const noexcept;

  // As above, without memory for the classes: calls sink for consecutive polygons of one class, in stored order.
  // polygons: of the cell's set.
  // sink: user is the last argument of decode. On corrupt, it may have been called for a part of the polygons.
  using class_sink = void (*)(void* user, std::uint8_t one, std::uint32_t count) noexcept;
  status decode(std::uint32_t cell, std::uint32_t polygons, class_sink sink, void* user) const noexcept;

 private:
  [[nodiscard]] bool read_codes(std::span<const std::byte>& bytes) noexcept;
  [[nodiscard]] bool bytes_of(std::uint32_t chunk, std::span<const std::byte>& out,
                              std::uint32_t& checksum) const noexcept;

  // Indexed by the next bits: the symbol, and in the upper byte the number of bits of its code; 0: no code.
  using code_entries = std::array<std::uint16_t, std::size_t{1} << longest_code>;
  [[nodiscard]] static bool read_code(std::span<const std::byte>& bytes, std::uint32_t symbols,
                                      code_entries& entries) noexcept;

  std::span<const std::byte> directory_;
  std::span<const std::byte> chunks_;
  chunk_borders borders_;
  std::array<code_entries, importance_class_count> codes_{};  // by the class before
  code_entries runs_{};                                       // lengths of runs of the last class
};

}  // namespace sightcell::format
