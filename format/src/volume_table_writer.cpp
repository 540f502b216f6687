#include "volume_table_writer.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/volume_table.h"

namespace sightcell::format {

status put_volumes(const lattice_volumes& volumes, std::vector<std::byte>& out) {
  const lattice_shape& shape = volumes.shape;
  if (!(shape.width > 0.0) || !(shape.height > 0.0)) return status::argument;  // an infinite one has no box
  std::vector<std::array<std::int32_t, 3>> sorted;
  std::vector<std::vector<std::uint32_t>> columns(layout::volume_columns);
  for (const lattice_place& p : volumes.places) {
    if (!is_volume_place(shape, p)) return status::argument;
    sorted.push_back({p.x, p.y, p.z});
    for (std::size_t axis = 0; axis < 3; ++axis) columns[axis].push_back(from_signed(sorted.back()[axis]));
  }
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return status::argument;
  byte_sink bytes(out);
  bytes.put_f64(shape.width);
  bytes.put_f64(shape.height);
  bytes.put_u32(static_cast<std::uint32_t>(volumes.places.size()));
  put_columns(columns, out);
  return status::ok;
}

}  // namespace sightcell::format
