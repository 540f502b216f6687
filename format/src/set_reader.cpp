#include "sightcell/format/set_reader.h"

#include <algorithm>

namespace sightcell::format {

status set_reader::open(const reader& file) {
  file_ = file;
  codes_memory_.assign(file.codes_size(), {});
  row_.resize(file.run_bound());
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

status set_reader::source_ids(std::uint32_t cell, std::vector<std::uint32_t>& out) {
  out.clear();
  std::span<const run> stored;
  if (const status s = runs(cell, stored); s != status::ok) return s;
  for (const run& r : stored) {
    const auto from = source_of_stored_.begin() + r.first;
    out.insert(out.end(), from, from + r.count);
  }
  std::sort(out.begin(), out.end());
  return status::ok;
}

status set_reader::check() {
  std::vector<std::uint32_t> stored(file_.polygon_count());
  return file_.check(codes_, row_, scratch_, stored);
}

status set_reader::statistics(row_statistics& sums) {
  return file_.statistics(codes_, row_, scratch_, sums);
}

}  // namespace sightcell::format
