// Faults of the header and the section table.
#include <bit>
#include <limits>

#include "checksum.h"
#include "damaged_file.h"
#include "golden_contents.h"
#include "sightcell/format/layout.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using format::status;

constexpr std::uint32_t unknown_section = 20;

std::uint32_t bits_of(float value) {
  return std::bit_cast<std::uint32_t>(value);
}

// run bound, range bound
bytes with_bounds(const bytes& file, std::uint32_t runs, std::uint32_t ranges) {
  bytes out = file;
  set_u32(out, layout::header_run_bound, runs);
  set_u32(out, layout::header_range_bound, ranges);
  reseal(out);
  return out;
}

void damage_values(const bytes& tiny, damaged_list& list) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  struct fault {
    const char* name;
    std::uint64_t at;
    std::uint32_t value;
    status expected;
  };
  for (const fault& f : {
           fault{"version_2", layout::header_version, 2, status::version},
           fault{"sections_above_limit", layout::header_section_count, 65, status::limit},
           fault{"section_table_leaves_file", layout::header_section_count, 64, status::corrupt},
           fault{"polygons_above_limit", layout::header_polygon_count, 0xFFFFFFFFu, status::limit},
           fault{"draws_miss_last_polygon", layout::header_polygon_count, 7, status::corrupt},
           fault{"host_layout_2", layout::header_layout, 2, status::corrupt},
           fault{"margin_nan", layout::header_margin, bits_of(nan), status::corrupt},
           fault{"margin_infinite", layout::header_margin, bits_of(std::numeric_limits<float>::infinity()),
                 status::corrupt},
           fault{"margin_negative", layout::header_margin, bits_of(-0.25f), status::corrupt},
           fault{"margin_above_limit", layout::header_margin, bits_of(2.0e6f), status::limit},
           fault{"error_above_1", layout::header_max_pixel_error, bits_of(1.5f), status::corrupt},
           fault{"confidence_nan", layout::header_confidence, bits_of(nan), status::corrupt},
           fault{"flags_2", layout::header_flags, 2, status::corrupt},
           fault{"cells_above_limit", layout::header_cell_count, layout::max_cells + 1, status::limit},
           fault{"draws_above_limit", layout::header_draw_count, layout::max_draws + 1, status::limit},
           fault{"range_bound_below_runs", layout::header_range_bound, 1, status::corrupt},
           fault{"range_bound_above_draws", layout::header_range_bound, 4, status::corrupt},
           fault{"list_bound_above_rows", layout::header_list_bound, 57, status::corrupt},
           fault{"slack_above_1", layout::header_slack, bits_of(1.5f), status::corrupt},
           fault{"slack_nan", layout::header_slack, bits_of(nan), status::corrupt},
       }) {
    list.push_back({f.name, f.expected, changed(tiny, f.at, f.value)});
  }
}

void damage_bounds(const bytes& tiny, damaged_list& list) {
  list.push_back({"run_bound_above_polygons", status::corrupt, with_bounds(tiny, 7, 7)});
  // Which has more ranges than runs, so that the range bound stays right.
  const bytes lattice = lattice_contents().encode();
  list.push_back({"run_bound_above_runs", status::corrupt,
                  changed(lattice, layout::header_run_bound, get_u32(lattice, layout::header_run_bound) + 1)});
  list.push_back({"run_bound_below_runs", status::corrupt, with_bounds(tiny, 1, 2)});
  list.push_back({"range_bound_above_ranges", status::corrupt, changed(tiny, layout::header_range_bound, 3)});

  sample_contents large = tiny_contents();
  large.facts.polygon_count = large.draws[0].polygon_count = 100;
  list.push_back({"undamaged_large", status::ok, large.encode()});
  const std::uint64_t rows = get_u64(list.back().bytes, section_place(list.back().bytes, layout::section_rows) + 16);
  const auto most = static_cast<std::uint32_t>(4 * rows);
  list.push_back({"run_bound_above_rows", status::corrupt, with_bounds(list.back().bytes, most + 1, most + 1)});

  sample_contents nothing = tiny_contents();
  nothing.sets = {{}, {}};
  list.push_back({"undamaged_nothing_seen", status::ok, nothing.encode()});
  list.push_back({"ranges_without_runs", status::corrupt, with_bounds(list.back().bytes, 0, 1)});
}

}  // namespace

damaged_list damaged_headers() {
  const bytes tiny = tiny_contents().encode();
  damaged_list list;
  const auto add = [&](const char* name, status expected) -> bytes& {
    list.push_back({name, expected, tiny});
    return list.back().bytes;
  };
  bytes& other = add("magic_of_another_file", status::not_ours);
  other[1] = std::byte{'p'};
  reseal(other);
  add("cut_inside_header", status::truncated).resize(60);
  add("cut_inside_magic", status::truncated).resize(5);
  add("cut_inside_version", status::truncated).resize(10);
  add("cut_by_a_byte", status::truncated).pop_back();
  add("longer_by_a_byte", status::corrupt).push_back(std::byte{0});
  add("header_checksum", status::checksum)[layout::header_fingerprint] ^= std::byte{1};
  damage_values(tiny, list);
  damage_bounds(tiny, list);
  return list;
}

namespace {

void damage_checksums(const bytes& whole, damaged_list& list) {
  const auto add = [&](const std::string& name, bytes file, std::size_t at) {
    file[at] ^= std::byte{1};
    reseal_front(file);
    list.push_back({name, status::checksum, std::move(file)});
  };
  for (std::uint32_t id = layout::section_draws; id <= layout::section_codes; ++id) {
    add("section_" + std::to_string(id) + "_checksum", whole, section_place(whole, id) + 24);
  }
  const bytes skipped = with_record(whole, layout::section_settings, unknown_section, 0);
  add("section_20_checksum", skipped, section_place(skipped, unknown_section) + 24);

  bytes table = whole;
  set_u32(table, layout::header_table_checksum, get_u32(table, layout::header_table_checksum) ^ 1u);
  set_u32(table, layout::header_checksum, format::crc32c(std::span(table).first(layout::header_checksum)));
  list.push_back({"section_table_checksum", status::checksum, std::move(table)});

  // A chunk's own, under a section's that fits.
  bytes chunk = whole;
  chunk[section_offset(chunk, layout::section_row_directory) + 12] ^= std::byte{1};
  const bytes directory = section_of(chunk, layout::section_row_directory);
  set_u32(chunk, section_place(chunk, layout::section_row_directory) + 24, format::crc32c(directory));
  reseal_front(chunk);
  list.push_back({"chunk_checksum", status::checksum, std::move(chunk)});
}

// The second section begins some bytes later, and is as many shorter.
bytes with_gap(const bytes& file, std::int64_t gap) {
  bytes out = file;
  const std::size_t record = layout::header_size + layout::section_record_size;
  set_u64(out, record + 8, get_u64(out, record + 8) + static_cast<std::uint64_t>(gap));
  set_u64(out, record + 16, get_u64(out, record + 16) - static_cast<std::uint64_t>(gap));
  reseal(out);
  return out;
}

}  // namespace

damaged_list damaged_section_tables() {
  const bytes whole = whole_contents().encode();
  damaged_list list;
  list.push_back({"undamaged_whole", status::ok, whole});
  for (const std::uint32_t id : {layout::section_draws, layout::section_cells, layout::section_rows,
                                 layout::section_row_directory, layout::section_orders, layout::section_codes}) {
    list.push_back(
        {"section_" + std::to_string(id) + "_missing", status::corrupt, with_record(whole, id, unknown_section, 0)});
  }
  constexpr std::uint32_t settings = layout::section_settings;
  list.push_back({"section_9_required", status::version, with_record(whole, settings, layout::section_importance, 1)});
  list.push_back({"section_17_required", status::version, with_record(whole, settings, layout::section_casters, 1)});
  list.push_back({"section_18_required", status::version, with_record(whole, settings, layout::section_residency, 1)});
  list.push_back({"section_19_required", status::version, with_record(whole, settings, layout::section_lights, 1)});
  list.push_back({"section_20_skipped", status::ok, with_record(whole, settings, unknown_section, 0)});
  list.push_back({"section_20_required", status::version, with_record(whole, settings, unknown_section, 1)});
  // Any bytes are settings.
  list.push_back({"settings_twice", status::corrupt, with_record(whole, layout::section_certificate, settings, 0)});
  list.push_back({"draw_table_twice", status::corrupt, with_record(whole, settings, layout::section_draws, 1)});
  list.push_back({"settings_required", status::corrupt, with_record(whole, settings, settings, 1)});
  list.push_back({"draw_table_not_required", status::corrupt,
                  with_record(whole, layout::section_draws, layout::section_draws, 0)});
  list.push_back({"section_flags_2", status::corrupt, with_record(whole, settings, settings, 2)});
  list.push_back({"section_reserved", status::corrupt, changed(whole, section_place(whole, settings) + 28, 1)});
  list.push_back({"section_gap", status::corrupt, with_gap(whole, 1)});
  list.push_back({"sections_overlap", status::corrupt, with_gap(whole, -1)});

  bytes longer_section = whole;  // rows are the last
  const std::size_t size_of_rows = section_place(whole, layout::section_rows) + 16;
  set_u64(longer_section, size_of_rows, get_u64(whole, size_of_rows) + 1);
  reseal(longer_section);
  list.push_back({"section_leaves_file", status::corrupt, std::move(longer_section)});

  bytes far_section = whole;
  set_u64(far_section, section_place(whole, layout::section_rows) + 8, std::uint64_t{1} << 40);
  reseal(far_section);
  list.push_back({"section_begins_behind_file", status::corrupt, std::move(far_section)});

  bytes longer_file = longer(whole, 1);
  set_u64(longer_file, layout::header_total_size, longer_file.size());
  reseal(longer_file);
  list.push_back({"byte_behind_sections", status::corrupt, std::move(longer_file)});
  damage_checksums(whole, list);
  return list;
}

}  // namespace sightcell::test
