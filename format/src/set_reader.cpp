#include "sightcell/format/set_reader.h"

#include <algorithm>

namespace sightcell::format {

status set_reader::open(const reader& file) {
  file_ = file;
  codes_memory_.assign(file.codes_size(), {});
  row_.resize(file.row_room());
  scratch_.resize(file.scratch_size());
  source_of_stored_.resize(file.polygon_count());
  if (const status s = file_.make_codes(codes_memory_, codes_); s != status::ok) return s;
  return file_.source_of_stored(source_of_stored_);
}

status set_reader::runs(std::uint32_t cell, std::span<const run>& out) {
  std::size_t count = 0;
  const status s = file_.decode_row(cell, codes_, row_, scratch_, count);
  out = std::span(row_).first(count);
  return s;
}

status set_reader::parts(std::uint32_t cell, row_parts& out) {
  return file_.decode_row(cell, codes_, row_, scratch_, out);
}

void set_reader::put_source_ids(std::span<const run> stored, std::vector<std::uint32_t>& out) const {
  out.clear();
  for (const run& r : stored) {
    const auto from = source_of_stored_.begin() + r.first;
    out.insert(out.end(), from, from + r.count);
  }
  std::sort(out.begin(), out.end());
}

status set_reader::source_ids(std::uint32_t cell, std::vector<std::uint32_t>& out) {
  std::span<const run> stored;
  const status s = runs(cell, stored);
  put_source_ids(stored, out);
  return s;
}

status set_reader::item_ids(std::uint32_t cell, std::vector<std::uint32_t>& out) {
  row_parts set;
  const status s = parts(cell, set);
  put_source_ids(set.polygons, out);
  for (const run& r : set.volumes) {
    for (std::uint32_t i = 0; i < r.count; ++i) out.push_back(file_.polygon_count() + r.first + i);
  }
  return s;
}

status set_reader::check() {
  std::vector<std::uint32_t> stored(file_.check_room());
  return file_.check(codes_, row_, scratch_, stored);
}

status set_reader::statistics(row_statistics& sums) {
  return file_.statistics(codes_, row_, scratch_, sums);
}

}  // namespace sightcell::format
