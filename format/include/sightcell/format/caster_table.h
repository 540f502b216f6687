#pragma once
// The casters section (SPEC.md, "Shadow casters"): for each cell and sun the polygons beside the set of the cell whose
// shadow can fall on what the cell sees. The counterpart for writing is caster_writer.h.
//
//   caster_table casters;
//   if (status s = caster_table::open(file, casters); s != status::ok) return s;   // absent: the file has none
//   std::vector<std::byte> memory(file.codes_size()), scratch(casters.scratch_size());
//   const row_codes* codes = nullptr;
//   if (status s = casters.make_codes(memory, codes); s != status::ok) return s;
//   std::vector<run> runs(casters.run_bound());
//   status s = casters.decode(cell, sun, codes, runs, scratch, count);   // runs[0 .. count)
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/extra_sets.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Unit vectors toward the sun; it moves from one direction to the other. Equal where it does not move.
struct sun_record {
  std::array<float, 3> from{}, to{};
};

// A view of the section: cheap to copy, valid as long as the bytes are. Safe for hostile bytes. No exceptions, no
// allocation; const functions may run on any number of threads at once. Default-constructed: no suns.
class caster_table {
 public:
  // Opens the section of a file, and checks its checksum and all of it but the rows. out: set only on ok. absent: the
  // file has none; checksum; corrupt; limit. A paged file has none in its front: checksum. O(bytes of the section).
  [[nodiscard]] static status open(const reader& file, caster_table& out) noexcept;

  [[nodiscard]] std::uint32_t sun_count() const noexcept { return suns_; }
  // argument: no such sun.
  status sun(std::uint32_t number, sun_record& out) const noexcept;

  // What trials of the casters of a cell proved. misses: trials in which a point that the cell sees lacks its shadow.
  // argument: no such cell or sun; corrupt: the bytes changed since open.
  status certificate(std::uint32_t cell, std::uint32_t sun, certificate_record& out) const noexcept;

  // The most runs of any caster set: the room that decode needs.
  [[nodiscard]] std::uint32_t run_bound() const noexcept { return sets_.run_bound(); }
  // Bytes of scratch that decode needs, at a multiple of 4.
  [[nodiscard]] std::size_t scratch_size() const noexcept { return sets_.scratch_size(); }
  // As reader::make_codes, with memory of reader::codes_size().
  status make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept {
    return sets_.make_codes(memory, out);
  }

  // Decodes the casters of a cell as runs in stored order: ascending, disjoint, not touching, inside polygon_count. A
  // host draws them and the set of the cell. As reader::decode_row.
  status decode(std::uint32_t cell, std::uint32_t sun, const row_codes* codes, std::span<run> out,
                std::span<std::byte> scratch, std::size_t& count) const noexcept;

  // Decodes every row. Returns ok or the first fault. out, scratch: as for decode.
  status check(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept {
    return sets_.check(codes, out, scratch);
  }

 private:
  std::span<const std::byte> bytes_;
  std::uint32_t cells_ = 0, suns_ = 0;
  extra_sets sets_;  // the suns of a cell one after the other
};

}  // namespace sightcell::format
