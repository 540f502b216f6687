// Faults of code tables and rows. Rows are made by hand here, as is the code: each symbol from 0 to 7 has three bits.
#include <algorithm>
#include <bit>
#include <utility>

#include "bit_sink.h"
#include "code_table_writer.h"
#include "damaged_file.h"
#include "number_symbols.h"
#include "sightcell/format/layout.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using format::status;
using format::symbol_lengths;
using run_list = std::vector<format::run>;

constexpr std::size_t tables = 6;
constexpr symbol_lengths three_bits{3, 3, 3, 3, 3, 3, 3, 3};

bytes codes_of(const symbol_lengths& first, const symbol_lengths& others) {
  bytes out;
  for (std::size_t i = 0; i < tables; ++i) format::put_code_lengths(i == 0 ? first : others, out);
  return out;
}

// A table that no row uses.
bytes with_unused_code(const bytes& tiny, const symbol_lengths& lengths) {
  bytes codes = longer(section_of(tiny, layout::section_codes), -1);
  format::put_code_lengths(lengths, codes);
  return with_section(tiny, layout::section_codes, codes);
}

void put_count(std::uint32_t count, format::bit_sink& out) {
  const auto width = static_cast<unsigned>(std::bit_width(count));
  out.put(width, 5);
  if (width > 0) out.put(count, width - 1);
}

void put_runs(const run_list& runs, format::bit_sink& out) {
  std::uint32_t next = 0;
  for (const format::run& r : runs) {
    const format::number_symbol gap = format::symbol_of(r.first - next);
    const format::number_symbol more = format::symbol_of(r.count - 1);
    for (const std::uint32_t symbol : {gap.symbol, more.symbol}) {
      for (const unsigned bit : {2u, 1u, 0u}) out.put(symbol >> bit, 1);
    }
    out.put(gap.raw, gap.raw_bits);
    out.put(more.raw, more.raw_bits);
    next = r.first + r.count + 1;
  }
}

bytes own_row(const run_list& runs) {
  bytes out;
  format::bit_sink bits(out);
  bits.put(0, 1);
  put_count(static_cast<std::uint32_t>(runs.size()), bits);
  put_runs(runs, bits);
  bits.align();
  return out;
}

bytes difference(std::uint32_t reference, const run_list& removed, const run_list& added) {
  bytes out;
  format::bit_sink bits(out);
  bits.put(1, 1);
  bits.put(reference, 6);
  put_count(static_cast<std::uint32_t>(removed.size()), bits);
  put_count(static_cast<std::uint32_t>(added.size()), bits);
  put_runs(removed, bits);
  put_runs(added, bits);
  bits.align();
  return out;
}

struct hand_made {
  std::vector<bytes> rows;
  std::vector<std::uint32_t> begins;  // of the rows
  std::uint32_t runs = 3, ranges = 3, list_runs = 1;
  unsigned width = 8;  // bits of a begin

  void follow_each_other() {
    begins.clear();
    std::uint32_t next = 0;
    for (const bytes& row : rows) {
      begins.push_back(next);
      next += static_cast<std::uint32_t>(row.size());
    }
  }
  [[nodiscard]] bytes chunk() const {
    bytes out;
    format::bit_sink bits(out);
    bits.put(width, 8);
    for (const std::uint32_t begin : begins) {
      bits.put(begin, std::min(width, 32u));
      if (width > 32) bits.put(0, width - 32);
    }
    bits.align();
    for (const bytes& row : rows) out.insert(out.end(), row.begin(), row.end());
    return longer(std::move(out), 8);
  }
};

// Eight polygons, five cells that see {0 1 2 4}, {1 2 4}, {1 2 4 7}, {5}, {0 5}: own rows, and differences that stand
// on one reference and on two.
hand_made hand_made_rows() {
  hand_made made;
  made.rows = {own_row({{0, 3}, {4, 1}}), difference(0, {{0, 1}}, {}), difference(1, {}, {{4, 1}}), own_row({{5, 1}}),
               difference(3, {}, {{0, 1}})};
  made.follow_each_other();
  return made;
}

// A file with these sets, made by the writer, with other codes and rows.
bytes file_of(const bytes& codes, const bytes& chunk, const hand_made& made) {
  sample_contents contents = tiny_contents();
  contents.facts.polygon_count = contents.draws[0].polygon_count = 8;
  contents.cells.clear();
  contents.sets = {{0, 1, 2, 4}, {1, 2, 4}, {1, 2, 4, 7}, {5}, {0, 5}};
  for (std::size_t i = 0; i < contents.sets.size(); ++i) {
    const auto x = 4.0f * static_cast<float>(i);
    contents.cells.push_back({{x, 0, 0}, {x + 4, 2, 4}});
  }
  bytes out = with_section(contents.encode(), layout::section_codes, codes);
  out = with_section(out, layout::section_rows, chunk);
  set_u32(out, layout::header_run_bound, made.runs);
  set_u32(out, layout::header_range_bound, made.ranges);
  set_u32(out, layout::header_list_bound, made.list_runs);
  reseal(out);
  return out;
}

bytes file_of(const hand_made& made) {
  return file_of(codes_of(three_bits, three_bits), made.chunk(), made);
}

// One row replaced; those behind it move.
void add_row(const char* name, std::size_t cell, const bytes& row, damaged_list& list) {
  hand_made made = hand_made_rows();
  made.rows[cell] = row;
  made.follow_each_other();
  list.push_back({name, status::corrupt, file_of(made)});
}

void damage_row(damaged_list& list) {
  add_row("run_leaves_scene", 3, own_row({{5, 4}}), list);
  add_row("own_row_above_run_bound", 3, own_row({{0, 1}, {2, 1}, {4, 1}, {6, 1}}), list);
  add_row("reference_to_itself", 4, difference(4, {}, {{0, 1}}), list);
  add_row("references_in_a_circle", 3, difference(4, {}, {{0, 1}}), list);
  add_row("references_3_deep", 4, difference(2, {}, {{0, 1}}), list);
  add_row("reference_leaves_chunk", 4, difference(5, {}, {{0, 1}}), list);
  add_row("removed_rank_beyond_last", 4, difference(3, {{1, 1}}, {}), list);
  add_row("added_rank_beyond_last", 4, difference(3, {}, {{7, 1}}), list);
  bytes cut = hand_made_rows().rows[4];
  cut.pop_back();
  add_row("row_cut", 4, cut, list);

  const auto add = [&](const char* name, auto damage) {
    hand_made made = hand_made_rows();
    damage(made);
    list.push_back({name, status::corrupt, file_of(made)});
  };
  add("set_above_run_bound", [](hand_made& made) { made.runs = 2; });
  add("list_bound_too_small", [](hand_made& made) { made.list_runs = 0; });
  add("row_begins_behind_rows", [](hand_made& made) { made.begins[4] = 100; });
  add("gap_between_rows", [](hand_made& made) {
    made.rows[4].insert(made.rows[4].begin(), std::byte{0});
    made.begins[4] += 1;
  });
  add("row_begins_inside_another", [](hand_made& made) {
    // The second byte of that row is zero, which is a row of no polygons.
    made.rows[3] = own_row({{4, 1}});
    made.follow_each_other();
    made.rows.pop_back();
    made.begins[4] = made.begins[3] + 1;
  });
  add("rows_in_another_order", [](hand_made& made) {
    std::swap(made.rows[0], made.rows[1]);
    made.begins[0] = static_cast<std::uint32_t>(made.rows[0].size());
    made.begins[1] = 0;
  });
  add("byte_behind_rows", [](hand_made& made) { made.rows[4].push_back(std::byte{0}); });
  add("begins_of_33_bits", [](hand_made& made) { made.width = 33; });

  const hand_made made = hand_made_rows();
  const bytes codes = codes_of(three_bits, three_bits);
  bytes cut_chunk = made.chunk();
  cut_chunk.resize(12);
  list.push_back({"chunk_cut", status::corrupt, file_of(codes, cut_chunk, made)});
}

// Where they end, and tables that the others do not meet.
void damage_further_codes(damaged_list& list) {
  const hand_made made = hand_made_rows();
  const auto add = [&](const char* name, const bytes& codes) {
    list.push_back({name, status::corrupt, file_of(codes, made.chunk(), made)});
  };
  bytes codes = codes_of(three_bits, three_bits);
  codes.resize(codes.size() / tables * (tables - 1));
  add("codes_of_5_tables", codes);
  add("gap_codes_incomplete", codes_of({0, 2, 2, 2}, three_bits));
  // The only length of own rows is coded as 0, and the first one's bits begin with 1.
  bytes lengths;
  for (std::size_t i = 0; i < tables; ++i) format::put_code_lengths(i == 1 ? symbol_lengths{1} : three_bits, lengths);
  hand_made long_run = hand_made_rows();
  long_run.rows[0] = own_row({{0, 5}});
  long_run.follow_each_other();
  list.push_back({"row_length_is_no_code", status::corrupt, file_of(lengths, long_run.chunk(), long_run)});
  list.push_back({"chunk_without_padding", status::corrupt, file_of(codes_of(three_bits, three_bits), bytes(7), made)});
}

}  // namespace

damaged_list damaged_code_tables() {
  const hand_made made = hand_made_rows();
  damaged_list list;
  const auto add = [&](const char* name, const bytes& codes) {
    list.push_back({name, status::corrupt, file_of(codes, made.chunk(), made)});
  };
  add("row_is_no_code", codes_of({0, 1}, three_bits));
  const bytes tiny = tiny_contents().encode();
  list.push_back({"undamaged_unused_code", status::ok, with_unused_code(tiny, {0, 2, 2, 1})});
  list.push_back({"codes_over_subscribed", status::corrupt, with_unused_code(tiny, {0, 2, 2, 1, 15})});
  list.push_back({"codes_incomplete", status::corrupt, with_unused_code(tiny, {0, 2, 2, 2})});
  list.push_back({"code_of_two_bits_alone", status::corrupt, with_unused_code(tiny, {0, 2})});
  const bytes codes = codes_of(three_bits, three_bits);
  add("codes_cut", longer(codes, -1));
  add("codes_longer", longer(codes, 1));
  // A table of as many symbols as a byte can say, as long as it says.
  bytes many = codes;
  many[0] = std::byte{65};
  many.insert(many.begin() + 5, 29, std::byte{0});
  add("codes_of_65_symbols", many);
  damage_further_codes(list);
  for (damaged_file& file : list) file.later = file.expected != status::ok;
  return list;
}

damaged_list damaged_rows() {
  damaged_list list;
  list.push_back({"undamaged_rows", status::ok, file_of(hand_made_rows())});
  damage_row(list);
  for (damaged_file& file : list) file.later = file.expected != status::ok;
  return list;
}

}  // namespace sightcell::test
