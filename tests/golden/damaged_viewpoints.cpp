// Faults of viewpoints.
#include <bit>
#include <limits>
#include <string>

#include "byte_sink.h"
#include "damaged_file.h"
#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"
#include "unit/format/viewpoint_samples.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using numbers = std::vector<std::uint32_t>;
using format::status;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

// tiny_contents(); half of the grown box of cell 0 is outside its region.
sample_contents contents_with_viewpoints() {
  sample_contents contents = tiny_contents();
  contents.player_radius = 0.125f;
  contents.viewpoints = {{.cell = 0, .valid_share = 0.5f, .outside_share = 0.25, .region = packed_nodes("201")},
                         {.cell = 1, .valid_share = 0.75f, .region = {}}};
  contents.settings = "{}";
  return contents;
}

// The section as the writer would make it of things that it refuses.
struct section_parts {
  float radius = 0.125f;
  std::vector<float> valid = {0.5f, 0.75f};
  std::vector<float> outside = {0.25f, 0.0f};
  numbers ends = {1, 1};
  bytes regions = packed_nodes("201");

  [[nodiscard]] bytes section() const {
    std::vector<numbers> columns(layout::viewpoint_columns);
    for (const float share : valid) columns[0].push_back(std::bit_cast<std::uint32_t>(share));
    for (const float share : outside) columns[1].push_back(std::bit_cast<std::uint32_t>(share));
    columns[2] = ends;
    bytes out;
    format::byte_sink sink(out);
    sink.put_f32(radius);
    format::put_columns(columns, out);
    sink.put_bytes(regions);
    return out;
  }
};

void damage_numbers(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const section_parts& made, status expected = status::corrupt) {
    list.push_back({name, expected, with_section(whole, layout::section_viewpoints, made.section())});
  };
  add("undamaged_viewpoints_again", {}, status::ok);
  add("player_radius_0", {.radius = 0.0f});
  add("player_radius_negative", {.radius = -1.0f});
  add("player_radius_nan", {.radius = nan_value});
  add("player_radius_infinite", {.radius = infinite});
  add("valid_share_0", {.valid = {0.5f, 0.0f}});
  add("valid_share_negative", {.valid = {-0.5f, 0.75f}});
  add("valid_share_above_1", {.valid = {0.5f, 1.5f}});
  add("valid_share_nan", {.valid = {nan_value, 0.75f}});
  add("undamaged_valid_share_1", {.valid = {1.0f, 1.0f}}, status::ok);
  add("outside_share_negative", {.outside = {-0.5f, 0.0f}});
  add("outside_share_above_1", {.outside = {1.5f, 0.0f}});
  add("outside_share_nan", {.outside = {nan_value, 0.0f}});
  add("outside_share_of_whole_box", {.outside = {0.25f, 0.25f}});
  add("undamaged_outside_share_1", {.outside = {1.0f, 0.0f}}, status::ok);
}

void damage_ends(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const section_parts& made, status expected = status::corrupt) {
    list.push_back({name, expected, with_section(whole, layout::section_viewpoints, made.section())});
  };
  add("region_ends_descend", {.ends = {1, 0}});
  add("region_ends_early", {.outside = {0.0f, 0.0f}, .ends = {0, 0}});
  add("region_ends_late", {.ends = {1, 2}});
  add("region_above_section", {.ends = {1, 65537}});
  add("region_above_limit", {.ends = {1, 65538}}, status::limit);
  add("first_region_above_limit", {.ends = {65537, 65537}}, status::limit);
  add("undamaged_viewpoints_of_whole_boxes", {.outside = {0.0f, 0.0f}, .ends = {0, 0}, .regions = {}}, status::ok);
  add("viewpoints_of_one_cell", {.valid = {0.5f}, .outside = {0.25f}, .ends = {1}});
}

void damage_sizes(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const bytes& section) {
    list.push_back({name, status::corrupt, with_section(whole, layout::section_viewpoints, section)});
  };
  const bytes section = section_parts().section();
  add("viewpoints_cut", longer(section, -1));
  add("viewpoints_longer", longer(section, 1));
  add("viewpoints_empty", {});
  add("viewpoints_cut_in_radius", bytes(section.begin(), section.begin() + 3));
  add("viewpoints_cut_in_descriptor", bytes(section.begin(), section.begin() + 27));
  add("viewpoint_column_of_33_bits", changed(section, 8, 33));
}

// Found by a check of the whole file.
void damage_regions(const bytes& whole, damaged_list& list) {
  const auto add_bytes = [&](const char* name, const bytes& region, status expected = status::corrupt) {
    const auto end = static_cast<std::uint32_t>(region.size());
    const section_parts made{.ends = {end, end}, .regions = region};
    list.push_back({name, expected, with_section(whole, layout::section_viewpoints, made.section()), true});
  };
  const auto add = [&](const char* name, const std::string& nodes, status expected = status::corrupt) {
    add_bytes(name, packed_nodes(nodes), expected);
  };
  add("region_without_split", "1");
  add("region_of_nothing", "200");
  add("region_node_3", "231");
  add("region_root_3", "3");
  add("region_cut", "2222");
  add("region_cut_after_leaf", "2221");
  add("region_byte_left", "20100");
  add("region_bits_left", "2011");
  const auto chain = [](std::size_t depth, bool lower) {
    std::string nodes;
    for (std::size_t i = 0; i < depth; ++i) nodes += lower ? "2" : "20";
    nodes += '1';
    return lower ? nodes + std::string(depth, '0') : nodes;
  };
  add("undamaged_region_of_18_lower_halves", chain(18, true), status::ok);
  add("undamaged_region_of_18_upper_halves", chain(18, false), status::ok);
  add("region_of_19_lower_halves", chain(19, true));
  add("region_of_19_upper_halves", chain(19, false));
}

// Splits of boxes that have no middle.
void damage_boxes(damaged_list& list) {
  const auto add = [&](const char* name, const format::box& cell, status expected = status::corrupt) {
    sample_contents contents = tiny_contents();
    contents.facts.margin = 0.0f;
    contents.cells[0] = {{0, 0, 0}, {1, 1, 1}};
    add_viewpoints(contents, 4);
    contents.viewpoints[0].region = packed_nodes("201");
    bytes whole = contents.encode();
    const std::size_t place = section_offset(whole, layout::section_cells) + 4;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      set_u32(whole, place + 4 * axis, std::bit_cast<std::uint32_t>(cell.min[axis]));
      set_u32(whole, place + 12 + 4 * axis, std::bit_cast<std::uint32_t>(cell.max[axis]));
    }
    reseal(whole);
    list.push_back({name, expected, std::move(whole), true});
  };
  add("region_between_floats", {{16777216, 0, 0}, {16777218, 1, 1}});
  add("undamaged_region_of_four_floats", {{16777216, 0, 0}, {16777224, 1, 1}}, status::ok);
  add("region_beyond_floats", {{2e38f, 0, 0}, {3e38f, 1, 1}});
}

void damage_records(const bytes& whole, damaged_list& list) {
  const std::uint32_t own = layout::section_viewpoints;
  list.push_back({"section_12_required", status::version, with_record(whole, own, own, 1)});
  list.push_back({"viewpoints_twice", status::corrupt, with_record(whole, layout::section_settings, own, 0)});
  bytes sum = whole;
  sum[section_place(sum, own) + 24] ^= std::byte{1};
  reseal_front(sum);
  list.push_back({"section_12_checksum", status::checksum, std::move(sum)});
}

}  // namespace

damaged_list damaged_viewpoints() {
  const bytes whole = contents_with_viewpoints().encode();
  damaged_list list;
  list.push_back({"undamaged_viewpoints", status::ok, whole});
  damage_numbers(whole, list);
  damage_ends(whole, list);
  damage_sizes(whole, list);
  damage_regions(whole, list);
  damage_boxes(list);
  damage_records(whole, list);
  return list;
}

}  // namespace sightcell::test
