#include "eye_table_writer.h"

#include <cstdint>

#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {

status put_eyes(const file_contents& contents, std::vector<std::byte>& out) {
  std::vector<std::vector<std::uint32_t>> ends(1);
  std::vector<std::vector<std::uint32_t>> steps(3);
  for (const viewpoint_record& v : contents.viewpoints) {
    if (v.eyes.size() > layout::max_eyes) return status::argument;
    for (const eye_steps& eye : v.eyes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (eye[axis] >= layout::eye_steps_per_side) return status::argument;
        steps[axis].push_back(eye[axis]);
      }
    }
    ends[0].push_back(static_cast<std::uint32_t>(steps[0].size()));
  }
  if (steps[0].empty()) return status::ok;
  put_columns(ends, out);
  put_columns(steps, out);
  return status::ok;
}

}  // namespace sightcell::format
