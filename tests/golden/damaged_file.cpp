#include "damaged_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "checksum.h"
#include "sightcell/format/layout.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;

std::size_t record_of(std::size_t number) {
  return layout::header_size + number * layout::section_record_size;
}

// Besides all faults of code tables and rows.
bool is_found_later(std::string_view name) {
  constexpr std::array<std::string_view, 11> names{"run_bound_above_runs",
                                                   "run_bound_below_runs",
                                                   "range_bound_above_ranges",
                                                   "section_3_checksum",
                                                   "section_20_checksum",
                                                   "chunk_checksum",
                                                   "sources_twice",
                                                   "step_is_no_code",
                                                   "order_has_polygon_twice",
                                                   "order_begins_before_draw",
                                                   "order_leaves_draw"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

damaged_list damaged_files() {
  damaged_list all;
  for (auto* part : {damaged_headers, damaged_section_tables, damaged_tables, damaged_groups, damaged_lattices,
                     damaged_code_tables, damaged_rows, damaged_importance, damaged_volumes, damaged_named_groups,
                     damaged_viewpoints, damaged_borders, damaged_clusters}) {
    damaged_list some = part();
    all.insert(all.end(), std::move_iterator(some.begin()), std::move_iterator(some.end()));
  }
  for (damaged_file& file : all) file.later = file.later || is_found_later(file.name);
  return all;
}

const char* status_name(format::status s) {
  switch (s) {
    case format::status::ok:
      return "ok";
    case format::status::not_ours:
      return "not_ours";
    case format::status::version:
      return "version";
    case format::status::truncated:
      return "truncated";
    case format::status::checksum:
      return "checksum";
    case format::status::corrupt:
      return "corrupt";
    case format::status::limit:
      return "limit";
    default:
      return "?";
  }
}

bytes changed(bytes file, std::size_t at, std::uint32_t value) {
  EXPECT_NE(get_u32(file, at), value);
  set_u32(file, at, value);
  reseal(file);
  return file;
}

bytes with_record(const bytes& file, std::uint32_t id, std::uint32_t new_id, std::uint32_t flags) {
  bytes out = file;
  const std::size_t place = section_place(out, id);
  set_u32(out, place, new_id);
  set_u32(out, place + 4, flags);
  reseal(out);
  return out;
}

bytes section_of(const bytes& file, std::uint32_t id) {
  const auto begin = file.begin() + static_cast<std::ptrdiff_t>(section_offset(file, id));
  return {begin, begin + static_cast<std::ptrdiff_t>(get_u64(file, section_place(file, id) + 16))};
}

bytes with_section(const bytes& file, std::uint32_t id, const bytes& section) {
  const std::size_t count = get_u32(file, layout::header_section_count);
  bytes out(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(record_of(count)));
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t here = get_u32(file, record_of(i));
    const bytes part = here == id ? section : section_of(file, here);
    set_u64(out, record_of(i) + 8, out.size());
    set_u64(out, record_of(i) + 16, part.size());
    out.insert(out.end(), part.begin(), part.end());
  }
  set_u64(out, layout::header_total_size, out.size());
  if (id == layout::section_rows && get_u32(file, layout::header_cell_count) <= layout::cells_per_block) {
    set_u32(out, section_offset(out, layout::section_row_directory) + 8, static_cast<std::uint32_t>(section.size()));
  }
  reseal(out);
  return out;
}

void reseal_front(bytes& file) {
  const std::size_t table = record_of(get_u32(file, layout::header_section_count)) - layout::header_size;
  set_u32(file, layout::header_table_checksum, format::crc32c(std::span(file).subspan(layout::header_size, table)));
  set_u32(file, layout::header_checksum, format::crc32c(std::span(file).first(layout::header_checksum)));
}

bytes longer(bytes section, int bytes_more) {
  section.resize(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(section.size()) + bytes_more));
  return section;
}

sample_contents whole_contents() {
  sample_contents contents = tiny_contents();
  contents.draws = {{.node = 2, .mesh = 1, .polygon_count = 3},
                    {.node = 3, .mesh = 1, .first_source = 3, .polygon_count = 3, .first_stored = 3, .base_vertex = 5}};
  contents.orders = {{2, 0, 1}};
  contents.order_of_draw = {0, 0};
  contents.certificate = {{0, 1000, 1, 0.0625, 0.9375, 1}, {1, 2000, 0, 0.03125, 0.9375, 2}};
  contents.facts.max_pixel_error = 0.0625f;
  contents.facts.confidence = 0.9375f;
  contents.settings = "{}";
  return contents;
}

}  // namespace sightcell::test
