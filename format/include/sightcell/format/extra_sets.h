#pragma once
// The sets of polygons of a section of its own, beside those of cells (SPEC.md, "Shadow casters"): the last part of
// the casters and lights sections. caster_table.h and light_table.h use it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// A view of the sets: cheap to copy, valid as long as the bytes are. Safe for hostile bytes. No exceptions, no
// allocation; const functions may run on any number of threads at once. Default-constructed: no sets.
class extra_sets {
 public:
  // The shape of the sets, from the begin of the section. polygons: of the file.
  struct shape {
    std::uint32_t count = 0, polygons = 0, run_bound = 0, list_bound = 0;
  };

  // Opens the sets and checks all but the chunks. bytes: from the certificate to the end of the section. out: set only
  // on ok. corrupt.
  [[nodiscard]] static status open(std::span<const std::byte> bytes, const shape& of, extra_sets& out) noexcept;

  [[nodiscard]] std::uint32_t count() const noexcept { return shape_.count; }
  // The most runs of any set: the room that decode needs.
  [[nodiscard]] std::uint32_t run_bound() const noexcept { return shape_.run_bound; }
  // Bytes of scratch that decode needs, at a multiple of 4.
  [[nodiscard]] std::size_t scratch_size() const noexcept;
  // As reader::make_codes, with memory of reader::codes_size().
  status make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept;

  // The certificate of a set. cell: for out. argument: no such set; corrupt: the bytes changed since open.
  status certificate(std::uint32_t set, std::uint32_t cell, certificate_record& out) const noexcept;

  // Decodes a set as runs in stored order: ascending, disjoint, not touching, inside the polygons. As
  // reader::decode_row.
  status decode(std::uint32_t set, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                std::size_t& count) const noexcept;

  // Decodes every set. Returns ok or the first fault. out, scratch: as for decode.
  status check(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept;

 private:
  [[nodiscard]] std::uint32_t chunks() const noexcept {
    return (shape_.count + layout::cells_per_block - 1) / layout::cells_per_block;
  }

  shape shape_;
  std::span<const std::byte> codes_, rows_;
  std::array<packed_column, layout::certificate_columns> certificate_;
  packed_column ends_;  // of chunks, in rows_
};

}  // namespace sightcell::format
