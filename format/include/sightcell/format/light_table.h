#pragma once
// The lights section (SPEC.md, "Lights"): for each lamp the polygons that its light reaches, and which lights touch
// what is visible from a cell. The counterpart for writing is light_writer.h.
//
//   light_table lights;
//   if (status s = light_table::open(file, lights); s != status::ok) return s;   // absent: the file has none
//   const extra_sets& sets = lights.sets();
//   std::vector<std::byte> memory(file.codes_size()), scratch(sets.scratch_size());
//   const row_codes* codes = nullptr;
//   if (status s = sets.make_codes(memory, codes); s != status::ok) return s;
//   std::vector<run> runs(sets.run_bound());
//   status s = sets.decode(light, codes, runs, scratch, count);   // runs[0 .. count)
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/extra_sets.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

struct light_record {
  std::uint32_t node = 0;            // number in the glTF file
  std::array<float, 3> position{};   // meters
  std::array<float, 3> direction{};  // unit vector, in which a spot light shines
  float range = 0.0f;                // meters, above 0; infinity: no limit
  float cone = 0.0f;                 // of a spot light: angle between axis and edge, radians, up to pi / 2; 0: point

  bool operator==(const light_record&) const = default;
};

// A view of the section: cheap to copy, valid as long as the bytes are. Safe for hostile bytes. No exceptions, no
// allocation; const functions may run on any number of threads at once. Default-constructed: no lights.
class light_table {
 public:
  // Opens the section of a file, and checks its checksum and all of it but the rows. out: set only on ok. absent: the
  // file has none; checksum; corrupt; limit. A paged file has none in its front: checksum. O(bytes of the section).
  [[nodiscard]] static status open(const reader& file, light_table& out) noexcept;

  [[nodiscard]] std::uint32_t light_count() const noexcept { return lights_; }
  // argument: no such light; corrupt: the bytes changed since open.
  status light(std::uint32_t number, light_record& out) const noexcept;

  // The polygons that each light reaches, by its number. Of a certificate the cell is that number; misses: rays from
  // the light that met a polygon beside its set.
  [[nodiscard]] const extra_sets& sets() const noexcept { return sets_; }

  // Returns whether a light reaches a polygon of the set of a cell. False if there is no such cell or light.
  [[nodiscard]] bool touches(std::uint32_t cell, std::uint32_t light) const noexcept;

 private:
  std::span<const std::byte> bytes_, touching_;
  std::uint32_t cells_ = 0, lights_ = 0;
  extra_sets sets_;
};

}  // namespace sightcell::format
