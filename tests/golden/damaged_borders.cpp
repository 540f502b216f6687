// Faults of the chunk borders.
#include <gtest/gtest.h>

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

// The columns of the section. The contents have two blocks, of 64 and of 24 cells.
struct border_columns {
  numbers first, low, high;

  explicit border_columns(const bytes& file) {
    format::chunk_borders borders;
    const bytes section = section_of(file, layout::section_borders);
    const std::uint32_t cells = get_u32(file, layout::header_cell_count);
    EXPECT_TRUE(borders.open(section, cells));
    first = {0, borders.chunk_of(64).number};
    low = high = {0, 0};
    for (std::uint32_t cell = 0; cell < cells; cell = borders.chunk_of(cell).end()) {
      (cell % 64 < 32 ? low : high)[cell / 64] |= 1u << cell % 32;
    }
  }

  [[nodiscard]] bytes section() const {
    bytes out;
    format::put_columns(std::vector<numbers>{first, low, high}, out);
    return out;
  }
};

// The lowest bit above bit 0.
std::uint32_t second_begin(std::uint32_t begins) {
  const std::uint32_t rest = begins & ~1u;
  EXPECT_NE(rest, 0u);
  return rest & (~rest + 1);
}

void damage_columns(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, auto damage, status expected = status::corrupt) {
    border_columns columns(whole);
    damage(columns);
    list.push_back({name, expected, with_section(whole, layout::section_borders, columns.section())});
  };
  add(
      "undamaged_borders_again", [](border_columns&) {}, status::ok);
  add("borders_without_first_cell", [](border_columns& c) { c.low[0] ^= 3; });
  add("borders_without_first_cell_of_block", [](border_columns& c) { c.low[1] ^= 3; });
  add("borders_of_no_chunk", [](border_columns& c) { c.low[1] = c.high[1] = 0; });
  add("borders_behind_last_cell", [](border_columns& c) { c.low[1] ^= second_begin(c.low[1]) | 1u << 24; });
  add("borders_far_behind_last_cell", [](border_columns& c) {
    c.low[1] ^= second_begin(c.low[1]);
    c.high[1] = 1u << 31;
  });
  add("borders_begin_at_1", [](border_columns& c) {
    for (std::uint32_t& number : c.first) ++number;
  });
  add("borders_number_skipped", [](border_columns& c) { ++c.first[1]; });
  add("borders_more_than_chunks", [](border_columns& c) { c.low[1] |= 1u << 23; });
  add("borders_fewer_than_chunks", [](border_columns& c) { c.low[1] = 1; });
}

void damage_bytes(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const bytes& section) {
    list.push_back({name, status::corrupt, with_section(whole, layout::section_borders, section)});
  };
  const bytes section = section_of(whole, layout::section_borders);
  add("borders_cut", longer(section, -1));
  add("borders_longer", longer(section, 1));
  add("borders_empty", {});
  add("borders_cut_in_descriptors", bytes(section.begin(), section.begin() + 23));
  add("border_column_of_33_bits", changed(longer(section, 1), 20, 33));
}

void damage_border_records(const bytes& whole, damaged_list& list) {
  constexpr std::uint32_t own = layout::section_borders;
  list.push_back({"borders_not_required", status::corrupt, with_record(whole, own, own, 0)});
  list.push_back({"borders_twice", status::corrupt, with_record(whole, layout::section_settings, own, 1)});
  list.push_back({"borders_missing", status::corrupt, with_record(whole, own, 18, 0)});
  bytes sum = whole;
  sum[section_place(sum, own) + 24] ^= std::byte{1};
  reseal_front(sum);
  list.push_back({"section_14_checksum", status::checksum, std::move(sum)});
}

}  // namespace

damaged_list damaged_borders() {
  sample_contents contents = lattice_contents();
  contents.settings = "{}";
  contents.chunk_bytes = 80;
  const bytes whole = contents.encode();
  damaged_list list;
  list.push_back({"undamaged_borders", status::ok, whole});
  damage_columns(whole, list);
  damage_bytes(whole, list);
  damage_border_records(whole, list);
  // A border one cell later: the rows of two chunks have another number of cells then.
  border_columns moved(whole);
  const std::uint32_t begin = second_begin(moved.low[0]);
  moved.low[0] ^= begin | begin << 1;
  list.push_back(
      {"border_moved", status::corrupt, with_section(whole, layout::section_borders, moved.section()), true});
  return list;
}

}  // namespace sightcell::test
