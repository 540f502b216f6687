#include "viewpoint_table_writer.h"

#include <bit>
#include <cstdint>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "record_rules.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/viewpoint_table.h"
#include "table_encoder.h"

namespace sightcell::format {
namespace {

status check_region(std::span<const std::byte> region, const box& grown) {
  region_walk walk(region, grown);
  for (region_part part; walk.next(part);) {
  }
  return walk.result() == status::corrupt ? status::argument : walk.result();
}

}  // namespace

status put_viewpoints(const file_contents& contents, std::vector<std::byte>& out) {
  const std::size_t cells = cell_count(contents);
  if (contents.viewpoints.size() != cells || !is_player_radius(contents.player_radius)) return status::argument;
  std::vector<std::vector<std::uint32_t>> columns(layout::viewpoint_columns);
  std::vector<std::byte> regions;
  for (std::size_t i = 0; i < cells; ++i) {
    const viewpoint_record& v = contents.viewpoints[i];
    if (v.cell != i || !viewpoint_shares_are_valid(v.valid_share, v.outside_share, v.region.empty())) {
      return status::argument;
    }
    const box grown = grown_box(box_of_cell(contents, i), contents.facts.margin);
    if (const status s = check_region(v.region, grown); s != status::ok) return s;
    if (v.region.size() > layout::max_regions_size - regions.size()) return status::limit;
    regions.insert(regions.end(), v.region.begin(), v.region.end());
    columns[0].push_back(std::bit_cast<std::uint32_t>(v.valid_share));
    columns[1].push_back(bits_toward(v.outside_share, 2.0f));
    columns[2].push_back(static_cast<std::uint32_t>(regions.size()));
  }
  byte_sink bytes(out);
  bytes.put_f32(contents.player_radius);
  put_columns(columns, out);
  bytes.put_bytes(regions);
  return status::ok;
}

}  // namespace sightcell::format
