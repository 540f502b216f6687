#pragma once
// The caster sets of a file, by source ids.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/format/caster_table.h"
#include "sightcell/format/reader.h"

namespace sightcell::bake {

// Reads the casters section of a file, one set at a time.
class caster_set_reader {
 public:
  // Opens the section. absent: the file has none. file must outlive the object.
  format::status open(const format::reader& file);
  const format::caster_table& table() const { return table_; }
  // Writes the casters of a cell and sun to out, ascending.
  format::status source_ids(std::uint32_t cell, std::uint32_t sun, std::vector<std::uint32_t>& out);

 private:
  format::caster_table table_;
  const format::row_codes* codes_ = nullptr;
  std::vector<std::byte> memory_, scratch_;
  std::vector<format::run> runs_;
  std::vector<std::uint32_t> sources_;
};

// Copies the casters section from another file with the same cells and polygons into `file`, whose sets may be larger
// and stored in another order. Does nothing if `from` has no section. name: of the file, for errors.
void carry_casters(const format::reader& from, std::vector<std::byte>& file, const std::string& name);

}  // namespace sightcell::bake
