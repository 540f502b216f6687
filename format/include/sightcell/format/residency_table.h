#pragma once
// The texture residency section (SPEC.md, "Texture residency"): for each cell and texture the finest mip level that a
// picture from the cell can need. The counterpart for writing is residency_writer.h.
//
//   residency_table residency;
//   if (status s = residency_table::open(file, residency); s != status::ok) return s;   // absent: the file has none
//   std::vector<std::byte> memory(residency_table::codes_size());
//   const residency_codes* codes = nullptr;
//   if (status s = residency.make_codes(memory, codes); s != status::ok) return s;
//   std::vector<std::uint8_t> levels(residency.texture_count());
//   status s = residency.decode(cell, codes, levels);   // one for each texture
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Numbers of quarter levels: number n is the mip level (n - level_zero) / 4, 0 that no polygon of the set has the
// texture.
inline constexpr std::uint8_t no_level = 0;
inline constexpr std::uint8_t finest_level = 1;  // level -4 or any finer one
inline constexpr std::uint8_t level_zero = 17;
inline constexpr std::uint8_t quarters_of_level = 4;

struct texture_record {
  std::uint32_t image = 0;              // number in the glTF file
  std::uint32_t width = 0, height = 0;  // texels of level 0, 1 .. max_texture_side

  bool operator==(const texture_record&) const = default;
};

// Returns the number of the level of one texel, the coarsest one of a texture. Sides: above 0.
[[nodiscard]] constexpr std::uint8_t coarsest_level(const texture_record& of) noexcept {
  const std::uint32_t longest = of.width > of.height ? of.width : of.height;
  return static_cast<std::uint8_t>(level_zero + quarters_of_level * (std::bit_width(longest) - 1));
}

// Opaque: the codes of a section, in memory of the caller.
struct residency_codes;

// A view of the section: cheap to copy, valid as long as the bytes are. Safe for hostile bytes. No exceptions, no
// allocation; const functions may run on any number of threads at once. Default-constructed: no textures.
class residency_table {
 public:
  // Opens the section of a file, and checks its checksum and all of it but the chunks. out: set only on ok. absent: the
  // file has none; limit: too many textures; checksum, corrupt: the section is damaged. O(section).
  static status open(const reader& file, residency_table& out) noexcept;

  [[nodiscard]] std::uint32_t texture_count() const noexcept { return textures_; }
  // The density of pixels that the levels are for.
  [[nodiscard]] float pixels_per_radian() const noexcept { return pixels_per_radian_; }
  // The largest anisotropy of the filter that the levels are for, 1 .. 16.
  [[nodiscard]] float anisotropy() const noexcept { return anisotropy_; }
  // Any record for a number that does not exist.
  [[nodiscard]] texture_record texture(std::uint32_t number) const noexcept;

  // Bytes of the codes, for make_codes.
  [[nodiscard]] static std::size_t codes_size() noexcept;
  // Makes the codes that decode() needs. memory: codes_size() bytes, aligned to 8; they must outlive the codes.
  // capacity: memory is too small; corrupt: invalid codes.
  status make_codes(std::span<std::byte> memory, const residency_codes*& out) const noexcept;

  // Writes the number of the level of each texture to levels, which has texture_count() elements or more.
  // argument: no such cell, or no codes; capacity: levels is too small; corrupt: levels is undefined.
  // O(textures + changes of the cells before it in its chunk).
  status decode(std::uint32_t cell, const residency_codes* codes, std::span<std::uint8_t> levels) const noexcept;

  // Decodes all chunks. levels: as for decode.
  status check(const residency_codes* codes, std::span<std::uint8_t> levels) const noexcept;

 private:
  [[nodiscard]] std::uint32_t chunks() const noexcept {
    return cells_ / layout::cells_per_residency_chunk + (cells_ % layout::cells_per_residency_chunk != 0 ? 1u : 0u);
  }
  [[nodiscard]] status decode_chunk(std::uint32_t chunk, std::uint32_t cells, const residency_codes& codes,
                                    std::span<std::uint8_t> levels) const noexcept;

  std::uint32_t cells_ = 0;
  std::uint32_t textures_ = 0;
  float pixels_per_radian_ = 0.0f, anisotropy_ = 1.0f;
  packed_column image_, width_, height_, ends_;
  std::span<const std::byte> codes_;
  std::span<const std::byte> chunks_;  // with the padding
};

}  // namespace sightcell::format
