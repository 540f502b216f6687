// Faults of named groups.
#include <string>

#include "byte_sink.h"
#include "damaged_file.h"
#include "golden_contents.h"
#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using numbers = std::vector<std::uint32_t>;
using format::status;

// The section as the writer would make it of things that it refuses.
struct groups {
  std::string names = "doorlamp";
  numbers ends = {4, 8};
  numbers of_draws = {2, 0, 2, 1};

  [[nodiscard]] bytes section() const {
    bytes out;
    format::byte_sink sink(out);
    sink.put_u32(static_cast<std::uint32_t>(ends.size()));
    sink.put_u32(static_cast<std::uint32_t>(names.size()));
    sink.put_bytes(std::as_bytes(std::span(names)));
    for (const numbers* column : {&ends, &of_draws}) format::put_columns(std::span(column, 1), out);
    return out;
  }
};

void damage_names(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const groups& made, status expected = status::corrupt) {
    list.push_back({name, expected, with_section(whole, layout::section_named_groups, made.section())});
  };
  add("undamaged_named_groups_again", {}, status::ok);
  add("undamaged_names_of_any_bytes", {.names = std::string("\xFF\0\x80r", 4) + "lamp"}, status::ok);
  add("named_groups_none", {.names = "", .ends = {}, .of_draws = {0, 0, 0, 0}});
  add("name_empty", {.ends = {0, 8}});
  add("name_at_end_empty", {.ends = {8, 8}});
  add("names_descend", {.ends = {8, 4}});
  add("names_end_early", {.ends = {4, 7}});
  add("names_end_late", {.ends = {4, 9}});
  add("named_group_too_high", {.of_draws = {2, 0, 2, 3}});
  add("named_group_of_no_draw", {.of_draws = {0, 0, 0, 0}}, status::ok);
}

void damage_sizes(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const bytes& section, status expected = status::corrupt) {
    list.push_back({name, expected, with_section(whole, layout::section_named_groups, section)});
  };
  const bytes section = groups().section();
  add("named_groups_cut", longer(section, -1));
  add("named_groups_longer", longer(section, 1));
  add("named_groups_empty", {});
  add("named_groups_cut_in_head", bytes(section.begin(), section.begin() + 7));
  add("named_groups_cut_in_names", bytes(section.begin(), section.begin() + 15));
  add("named_groups_cut_in_descriptor", bytes(section.begin(), section.begin() + 23));
  add("names_above_limit", changed(section, 4, (1u << 24) + 1), status::limit);
  add("names_above_section", changed(section, 4, 1u << 24));
  add("more_named_groups_than_bytes", changed(section, 0, 9));
  add("name_column_of_33_bits", changed(section, 20, 33));
}

void damage_records(const bytes& whole, damaged_list& list) {
  const std::uint32_t own = layout::section_named_groups;
  list.push_back({"section_11_required", status::version, with_record(whole, own, own, 1)});
  list.push_back({"named_groups_twice", status::corrupt, with_record(whole, layout::section_settings, own, 0)});
  bytes sum = whole;
  sum[section_place(sum, own) + 24] ^= std::byte{1};
  reseal_front(sum);
  list.push_back({"section_11_checksum", status::checksum, std::move(sum)});
}

}  // namespace

damaged_list damaged_named_groups() {
  sample_contents contents = ordered_contents();
  contents.named_groups = {"door", "lamp"};
  contents.draws[0].named_group = contents.draws[2].named_group = 1;
  contents.draws[3].named_group = 0;
  contents.settings = "{}";
  const bytes whole = contents.encode();
  damaged_list list;
  list.push_back({"undamaged_named_groups", status::ok, whole});
  damage_names(whole, list);
  damage_sizes(whole, list);
  damage_records(whole, list);
  // Draws of one draw group are shown together.
  contents = named_contents();
  const bytes merged = contents.encode();
  groups split{"Schalter \xC3\xBCnothingdoor", {11, 18, 22}, {3, 3, 0, 0, 1, 1}};
  list.push_back({"draw_group_in_two_named_groups", status::corrupt,
                  with_section(merged, layout::section_named_groups, split.section())});
  split.of_draws = {3, 3, 3, 0, 1, 1};
  list.push_back(
      {"undamaged_named_draw_groups", status::ok, with_section(merged, layout::section_named_groups, split.section())});
  return list;
}

}  // namespace sightcell::test
