#pragma once
// The importance section (SPEC.md, "Importance"): of each polygon of a cell's set a class, by how much of all that is
// seen from the cell it covers. importance_writer.h is the way back.
//
//   importance_classes importance;
//   if (status s = file.importance(importance); s != status::ok) return s;   // argument: the file has none
//   // row[0 .. runs): as reader::decode_row gives them; polygons: the sum of their counts
//   status s = importance.decode(cell, std::span(classes).first(polygons));   // one per polygon, in stored order
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/status.h"

namespace sightcell::format {

// Classes are 0 .. 15, the most important first. Polygons of the last one are tiny, or nothing is known of them.
inline constexpr std::uint32_t importance_class_count = 16;
inline constexpr std::uint8_t least_important = importance_class_count - 1;

// A view of one section, of about 9 KiB; valid as long as the bytes are. Bytes are taken as hostile. No exceptions, no
// allocation; const functions may run on any number of threads at once.
class importance_classes {
 public:
  // Bits of the longest code.
  static constexpr unsigned longest_code = 8;

  // Of a file without cells.
  importance_classes() noexcept = default;
  // bytes: the section and nothing behind it. cells: of the file. checksum: directory or codes are damaged; corrupt:
  // they are none, or do not fill the bytes. out is set only on ok. O(cells / 64).
  static status open(std::span<const std::byte> bytes, std::uint32_t cells, importance_classes& out) noexcept;

  // As reader::check_chunk, of the chunk of the classes: reads all of it. Remember it.
  status check_chunk(std::uint32_t chunk) const noexcept;

  // The class of each polygon of a cell's set, in stored order. out: as many as the set has polygons. Looks at no
  // checksum: call check_chunk once before. argument: no such cell; corrupt: the bits are not so many classes; out
  // holds anything then. O(polygons of the cell).
  status decode(std::uint32_t cell, std::span<std::uint8_t> out) const noexcept;

 private:
  [[nodiscard]] bool read_codes(std::span<const std::byte>& bytes) noexcept;
  [[nodiscard]] bool chunk_of(std::uint32_t chunk, std::span<const std::byte>& out,
                              std::uint32_t& checksum) const noexcept;

  // By the next bits: the symbol, and above it in a byte how many bits its code has; 0: no code.
  using code_entries = std::array<std::uint16_t, std::size_t{1} << longest_code>;
  [[nodiscard]] static bool read_code(std::span<const std::byte>& bytes, std::uint32_t symbols,
                                      code_entries& entries) noexcept;

  std::span<const std::byte> directory_;
  std::span<const std::byte> chunks_;
  std::uint32_t cells_ = 0;
  std::array<code_entries, importance_class_count> codes_{};  // by the class before
  code_entries runs_{};                                       // how many more of the last class follow
};

}  // namespace sightcell::format
