// Faults of draws, orders, cells, the chunk directory and the certificate.
#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <limits>

#include "byte_sink.h"
#include "code_table_writer.h"
#include "damaged_file.h"
#include "golden_contents.h"
#include "packed_columns_writer.h"
#include "polygon_orders_writer.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "table_encoder.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using numbers = std::vector<std::uint32_t>;
using format::status;

void damage_draws(damaged_list& list) {
  const sample_contents contents = whole_contents();
  const bytes whole = contents.encode();
  const auto add = [&](const char* name, const std::function<void(sample_contents&)>& damage) {
    sample_contents damaged = contents;
    damage(damaged);
    list.push_back(
        {name, status::corrupt,
         with_section(whole, layout::section_draws, format::encode_draws(damaged.draws, damaged.order_of_draw))});
  };
  add("draw_group_1", [](auto& c) { c.draws[1].group = 1; });
  add("draw_order_unknown", [](auto& c) { c.order_of_draw[1] = 1; });
  add("draws_overlap", [](auto& c) { c.draws[1].first_stored = 2; });
  add("draw_leaves_scene", [](auto& c) { c.draws[1].first_source = 4; });
  add("sources_twice", [](auto& c) { c.draws[1].first_source = 0; });

  const bytes table = section_of(whole, layout::section_draws);
  list.push_back({"columns_cut", status::corrupt, with_section(whole, layout::section_draws, longer(table, -1))});
  list.push_back({"columns_longer", status::corrupt, with_section(whole, layout::section_draws, longer(table, 1))});
  // As long as two values of 33 bits make it.
  bytes wide = longer(table, 9);
  set_u32(wide, 8 * (layout::draw_columns - 1) + 4, 33);
  list.push_back({"column_of_33_bits", status::corrupt, with_section(whole, layout::section_draws, wide)});
}

// The orders section from its parts: one symbol of one bit, for number 0.
bytes orders_of(const numbers& polygons, const numbers& permutation_bytes, const bytes& permutations,
                const format::symbol_lengths& steps = {1}) {
  bytes out;
  format::byte_sink(out).put_u32(static_cast<std::uint32_t>(polygons.size() - 1));
  format::put_columns(std::vector<numbers>{polygons, permutation_bytes}, out);
  format::put_code_lengths(steps, out);
  out.insert(out.end(), permutations.begin(), permutations.end());
  return longer(std::move(out), 8);
}

void damage_orders(damaged_list& list) {
  const bytes whole = whole_contents().encode();
  const auto add = [&](const char* name, const bytes& section, status expected = status::corrupt) {
    list.push_back({name, expected, with_section(whole, layout::section_orders, section)});
  };
  const auto put = [](const std::vector<numbers>& orders) {
    bytes out;
    format::put_orders(orders, out);
    return out;
  };
  const bytes in_order(1);  // eight times the first code
  add("undamaged_orders", orders_of({0, 3}, {0, 1}, in_order), status::ok);
  add("order_has_polygon_twice", put({{2, 0, 0}}));
  add("order_leaves_draw", put({{3, 0, 1}}));
  add("order_begins_before_draw", orders_of({0, 3}, {0, 1}, in_order, {0, 1}));
  add("orders_begin_above_0", orders_of({1, 4}, {0, 1}, in_order));
  add("orders_descend", orders_of({0, 3, 2}, {0, 1, 1}, in_order));
  add("permutations_descend", orders_of({0, 3, 3}, {0, 2, 1}, in_order));
  add("more_polygons_than_bits", orders_of({0, 3, 12}, {0, 1, 2}, bytes(2)));  // in an order that no draw has
  add("orders_longer", longer(orders_of({0, 3}, {0, 1}, in_order), 1));
  add("steps_incomplete", orders_of({0, 3}, {0, 1}, in_order, {2, 2, 2}));
  add("step_is_no_code", orders_of({0, 3}, {0, 1}, bytes{std::byte{2}}));
}

// Orders that do not belong to the draws, and permutations that do not fill their bytes. Two draws with an order each.
void damage_order_counts(damaged_list& list) {
  sample_contents contents = whole_contents();
  contents.orders = {{2, 0, 1}, {0, 2, 1}};
  contents.order_of_draw = {0, 1};
  const bytes whole = contents.encode();
  const auto add = [&](const char* name, const numbers& order_of_draw, const bytes& orders, bool later = false) {
    const bytes draws = format::encode_draws(contents.draws, order_of_draw);
    list.push_back({name, status::corrupt,
                    with_section(with_section(whole, layout::section_draws, draws), layout::section_orders, orders),
                    later});
  };
  const auto put = [](const std::vector<numbers>& orders) {
    bytes out;
    format::put_orders(orders, out);
    return out;
  };
  list.push_back({"undamaged_two_orders", status::ok, whole});
  add("order_of_no_draw", {0, 0}, put(contents.orders));
  add("more_orders_than_draws", {0, 1}, put({{2, 0, 1}, {0, 2, 1}, {}}));
  // Three numbers of a bit, in two bytes; the same before another order.
  add("permutation_leaves_byte", {0, 0}, orders_of({0, 3}, {0, 2}, bytes(2)), true);
  add("permutation_leaves_byte_to_next", {0, 1}, orders_of({0, 3, 6}, {0, 2, 3}, bytes(3)), true);
  // Three numbers of three bits, in a byte.
  const format::symbol_lengths three_bits{3, 3, 3, 3, 3, 3, 3, 3};
  add("permutation_cut", {0, 0}, orders_of({0, 3}, {0, 1}, bytes(1), three_bits), true);
  add("permutation_goes_on_in_next", {0, 1}, orders_of({0, 3, 6}, {0, 1, 3}, bytes(3), three_bits), true);
  add("permutations_begin_above_0", {0, 0}, orders_of({0, 3}, {1, 2}, bytes(2)));
}

// The last draw makes them as many as there are, whatever the first one names.
void damage_order_turn(damaged_list& list) {
  sample_contents contents = whole_contents();
  contents.draws.push_back(contents.draws.back());
  for (std::uint32_t i = 0; i < 3; ++i) {
    contents.draws[i].polygon_count = 2;
    contents.draws[i].first_source = contents.draws[i].first_stored = 2 * i;
  }
  contents.orders = {{1, 0}, {0, 1}};
  contents.order_of_draw = {0, 1, 0};
  const bytes whole = contents.encode();
  list.push_back({"undamaged_three_draws", status::ok, whole});
  list.push_back({"orders_in_another_turn", status::corrupt,
                  with_section(whole, layout::section_draws, format::encode_draws(contents.draws, numbers{1, 0, 1}))});
}

// Tables that end too early, one part after the other, or promise more than they have.
void damage_table_sizes(damaged_list& list) {
  const bytes whole = whole_contents().encode();
  const auto add_cut = [&](const char* name, std::uint32_t section, std::size_t size) {
    bytes cut = section_of(whole, section);
    EXPECT_GT(cut.size(), size);
    cut.resize(size);
    list.push_back({name, status::corrupt, with_section(whole, section, cut)});
  };
  add_cut("columns_cut_in_descriptors", layout::section_draws, 50);
  add_cut("orders_cut_in_count", layout::section_orders, 3);
  add_cut("orders_cut_in_columns", layout::section_orders, 4 + 12);
  add_cut("cells_cut_in_kind", layout::section_cells, 3);
  add_cut("cells_cut", layout::section_cells, 4 + 24);

  // Two columns of two rows; then no code.
  bytes orders;
  format::byte_sink(orders).put_u32(1);
  format::put_columns(std::vector<numbers>{{0, 3}, {0, 1}}, orders);
  list.push_back({"orders_without_steps", status::corrupt, with_section(whole, layout::section_orders, orders)});

  // Draws without polygons that are all alike take no bit.
  sample_contents alike;
  alike.draws.assign(8 * 8 * layout::draw_columns, {});
  alike.order_of_draw.assign(alike.draws.size(), 0);
  alike.orders = {{}};
  list.push_back({"undamaged_draws_alike", status::ok, alike.encode()});
  list.push_back(
      {"more_draws_than_bits", status::corrupt,
       changed(list.back().bytes, layout::header_draw_count, static_cast<std::uint32_t>(alike.draws.size() + 1))});

  sample_contents contents = whole_contents();
  contents.draws[1].first_stored = 100;
  list.push_back(
      {"draw_stored_behind_scene", status::corrupt,
       with_section(whole, layout::section_draws, format::encode_draws(contents.draws, contents.order_of_draw))});

  const bytes two_chunks = lattice_contents().encode();
  const std::size_t second = section_offset(two_chunks, layout::section_row_directory) + layout::chunk_record_size;
  list.push_back({"chunk_begins_behind_rows", status::corrupt, changed(two_chunks, second + 4, 1)});
}

void damage_cells(damaged_list& list) {
  const bytes tiny = tiny_contents().encode();
  const std::size_t cells = section_offset(tiny, layout::section_cells);
  const bytes section = section_of(tiny, layout::section_cells);
  const auto as_bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  const auto add = [&](const char* name, std::size_t at, std::uint32_t value) {
    list.push_back({name, status::corrupt, changed(tiny, cells + at, value)});
  };
  add("cells_of_kind_3", 0, 3);
  add("cell_without_width", 4, as_bits(4.0f));
  add("cell_begins_nowhere", 4, as_bits(std::numeric_limits<float>::quiet_NaN()));
  add("cell_without_end", 16, as_bits(std::numeric_limits<float>::infinity()));
  list.push_back({"cells_longer", status::corrupt, with_section(tiny, layout::section_cells, longer(section, 1))});
}

void damage_directory(damaged_list& list) {
  const bytes two_chunks = lattice_contents().encode();
  const bytes directory = section_of(two_chunks, layout::section_row_directory);
  const std::size_t second = section_offset(two_chunks, layout::section_row_directory) + layout::chunk_record_size;
  const auto offset = static_cast<std::uint32_t>(get_u64(two_chunks, second));
  const std::uint32_t size = get_u32(two_chunks, second + 8);
  bytes gap = two_chunks;
  set_u32(gap, second, offset + 1);
  set_u32(gap, second + 8, size - 1);
  reseal(gap);
  list.push_back({"chunk_gap", status::corrupt, std::move(gap)});
  list.push_back({"chunk_leaves_rows", status::corrupt, changed(two_chunks, second + 8, size + 1)});
  list.push_back(
      {"byte_behind_chunks", status::corrupt,
       with_section(two_chunks, layout::section_rows, longer(section_of(two_chunks, layout::section_rows), 1))});
  list.push_back({"directory_longer", status::corrupt,
                  with_section(two_chunks, layout::section_row_directory, longer(directory, 16))});
}

void damage_certificate(damaged_list& list) {
  const sample_contents contents = whole_contents();
  const bytes whole = contents.encode();
  const auto add = [&](const char* name, const format::certificate_record& second) {
    const std::vector<format::certificate_record> damaged{contents.certificate[0], second};
    list.push_back(
        {name, status::corrupt, with_section(whole, layout::section_certificate, format::encode_certificate(damaged))});
  };
  add("misses_above_rays", {1, 1000, 1001, 0.5, 0.5, 2});
  add("certificate_above_1", {1, 1000, 0, 1.5, 0.5, 2});
  add("certificate_nan", {1, 1000, 0, std::numeric_limits<double>::quiet_NaN(), 0.5, 2});
  add("certificate_confidence_negative", {1, 1000, 0, 0.5, -0.5, 2});
  const bytes section = section_of(whole, layout::section_certificate);
  list.push_back(
      {"certificate_longer", status::corrupt, with_section(whole, layout::section_certificate, longer(section, 1))});
}

using chunk_list = std::vector<format::lattice_chunk>;

bytes lattice_of(const format::lattice_shape& shape, const chunk_list& chunks) {
  std::vector<numbers> columns(7);
  for (const format::lattice_chunk& c : chunks) {
    std::size_t column = 0;
    for (const std::uint32_t value :
         {format::from_signed(c.x), format::from_signed(c.y), format::from_signed(c.z), c.level, c.first_cell,
          static_cast<std::uint32_t>(c.mask), static_cast<std::uint32_t>(c.mask >> 32)}) {
      columns[column++].push_back(value);
    }
  }
  bytes out;
  format::byte_sink sink(out);
  sink.put_u32(layout::cells_are_on_lattice);
  sink.put_f64(shape.width);
  sink.put_f64(shape.height);
  sink.put_u32(static_cast<std::uint32_t>(chunks.size()));
  format::put_columns(columns, out);
  return out;
}

// Of a lattice without cells: where there are some, their boxes are none either.
void damage_shapes(damaged_list& list) {
  sample_contents contents = tiny_contents();
  contents.cells.clear();
  contents.sets.clear();
  contents.lattice = format::lattice_shape{4.0, 2.0};
  const bytes file = contents.encode();
  list.push_back({"undamaged_no_cells", status::ok, file});
  const auto add = [&](const char* name, const format::lattice_shape& shape) {
    list.push_back({name, status::corrupt, with_section(file, layout::section_cells, lattice_of(shape, {}))});
  };
  add("lattice_width_0", {0.0, 2.0});
  add("lattice_height_negative", {4.0, -2.0});
  add("lattice_height_nan", {4.0, std::numeric_limits<double>::quiet_NaN()});
  add("lattice_width_infinite", {std::numeric_limits<double>::infinity(), 2.0});
}

// Behind the last place that a number is kept for, where two floats are 128 places apart: a cell still has a box where
// they meet.
void damage_far_places(damaged_list& list) {
  const bytes tiny = tiny_contents().encode();
  const format::lattice_shape shape{1.0, 1.0};
  const format::lattice_chunk at_origin{.first_cell = 1, .mask = 1};
  const auto add = [&](const char* name, const format::lattice_chunk& far_chunk, status expected) {
    list.push_back(
        {name, expected, with_section(tiny, layout::section_cells, lattice_of(shape, {far_chunk, at_origin}))});
  };
  constexpr std::uint64_t last_row = std::uint64_t{1} << 56;
  add("undamaged_lattice_far_behind", {.z = -(1 << 27) + 4, .mask = 1}, status::ok);
  add("lattice_chunk_far_behind", {.z = -(1 << 27) - 9, .mask = last_row}, status::corrupt);
  add("undamaged_lattice_far_below", {.y = -(1 << 30) + 32, .mask = 1}, status::ok);
  add("lattice_layer_far_below", {.y = -(1 << 30) - 65, .mask = 1}, status::corrupt);
}

bytes grid_of(const format::lattice_shape& step, const std::vector<format::grid_box>& places) {
  std::vector<numbers> columns(6);
  for (const format::grid_box& p : places) {
    std::size_t column = 0;
    for (const std::uint32_t value : {format::from_signed(p.x), format::from_signed(p.y), format::from_signed(p.z),
                                      p.steps_x, p.steps_y, p.steps_z}) {
      columns[column++].push_back(value);
    }
  }
  bytes out;
  format::byte_sink sink(out);
  sink.put_u32(layout::cells_are_on_grid);
  sink.put_f64(step.width);
  sink.put_f64(step.height);
  format::put_columns(columns, out);
  return out;
}

// Of a grid without cells, as for lattices.
void damage_steps(damaged_list& list) {
  sample_contents contents = tiny_contents();
  contents.cells.clear();
  contents.sets.clear();
  contents.grid = format::lattice_shape{1.0, 0.5};
  const bytes file = contents.encode();
  list.push_back({"undamaged_grid_without_cells", status::ok, file});
  const auto add = [&](const char* name, const format::lattice_shape& step) {
    list.push_back({name, status::corrupt, with_section(file, layout::section_cells, grid_of(step, {}))});
  };
  add("grid_width_0", {0.0, 2.0});
  add("grid_height_negative", {4.0, -2.0});
  add("grid_height_nan", {4.0, std::numeric_limits<double>::quiet_NaN()});
  add("grid_width_infinite", {std::numeric_limits<double>::infinity(), 2.0});
}

// Of two cells.
void damage_grid(damaged_list& list) {
  const bytes tiny = tiny_contents().encode();
  const auto add_section = [&](const char* name, status expected, const bytes& section) {
    list.push_back({name, expected, with_section(tiny, layout::section_cells, section)});
  };
  const format::grid_box other{-3, -2, 7, 2, 4, 2};
  const auto add = [&](const char* name, status expected, const format::lattice_shape& step,
                       const format::grid_box& place) {
    add_section(name, expected, grid_of(step, {other, place}));
  };
  constexpr std::int32_t first = std::numeric_limits<std::int32_t>::min();
  constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  add("undamaged_grid_boxes_alike", status::ok, {1.0, 0.5}, other);
  add("grid_box_without_width", status::corrupt, {1.0, 0.5}, {1, 2, 3, 0, 1, 1});
  add("grid_box_without_height", status::corrupt, {1.0, 0.5}, {1, 2, 3, 1, 0, 1});
  add("grid_box_without_depth", status::corrupt, {1.0, 0.5}, {1, 2, 3, 1, 1, 0});
  add("undamaged_grid_of_most_steps", status::ok, {1.0, 0.5}, {first, first, first, most, most, most});
  add("grid_box_far_behind", status::corrupt, {1.0, 0.5}, {1, 2, first, 1, 1, 1});
  add("undamaged_grid_up_to_largest_floats", status::ok, {1.0, 1e38}, {0, 2, 0, 1, 1, 1});
  add("grid_beyond_floats", status::corrupt, {1.0, 1e38}, {0, 2, 0, 1, 2, 1});
  add("grid_below_floats", status::corrupt, {1e-300, 1.0}, {1, 2, 3, 1, 1, 1});
  const bytes good = grid_of({1.0, 0.5}, {other, {1, 2, 3, 1, 1, 1}});
  add_section("grid_longer", status::corrupt, longer(good, 1));
  add_section("grid_of_3_cells", status::corrupt, grid_of({1.0, 0.5}, {other, {1, 2, 3, 1, 1, 1}, {2, 2, 3, 1, 1, 1}}));
  add_section("grid_ends_in_columns", status::corrupt, bytes(good.begin(), good.end() - 1));
  add_section("grid_ends_in_step", status::corrupt, bytes(good.begin(), good.begin() + 12));
}

}  // namespace

damaged_list damaged_tables() {
  damaged_list list;
  damage_draws(list);
  damage_orders(list);
  damage_order_counts(list);
  damage_order_turn(list);
  damage_table_sizes(list);
  damage_cells(list);
  damage_directory(list);
  damage_certificate(list);
  return list;
}

damaged_list damaged_lattices() {
  const bytes whole = lattice_contents().encode();
  format::reader file;
  EXPECT_EQ(format::reader::open(whole, file), status::ok);
  const format::lattice_shape shape = file.lattice()->shape();
  chunk_list chunks;
  for (std::uint32_t i = 0; i < file.lattice()->chunk_count(); ++i) chunks.push_back(file.lattice()->chunk(i));
  damaged_list list;
  const auto add = [&](const char* name, const bytes& section) {
    list.push_back({name, status::corrupt, with_section(whole, layout::section_cells, section)});
  };
  damage_shapes(list);
  damage_far_places(list);
  damage_steps(list);
  damage_grid(list);
  add("lattice_beyond_floats", lattice_of({1e300, shape.height}, chunks));
  add("lattice_below_floats", lattice_of({shape.width, 1e-300}, chunks));
  add("lattice_longer", longer(lattice_of(shape, chunks), 1));
  bytes of_kind_3 = lattice_of(shape, chunks);
  set_u32(of_kind_3, 0, 3);
  add("lattice_of_kind_3", of_kind_3);
  const auto add_changed = [&](const char* name, const std::function<void(chunk_list&)>& damage) {
    chunk_list damaged = chunks;
    damage(damaged);
    add(name, lattice_of(shape, damaged));
  };
  add_changed("lattice_not_ascending", [](chunk_list& c) {
    // As many cells, so that they are numbered as before.
    std::swap(c[0].z, c[2].z);
    std::swap(c[0].x, c[2].x);
  });
  add_changed("lattice_chunk_twice", [](chunk_list& c) {
    format::lattice_chunk half = c[0];
    half.mask &= half.mask - 1;
    half.first_cell = 1;
    c[0].mask ^= half.mask;
    c.insert(c.begin() + 1, half);
  });
  add_changed("lattice_chunk_without_cells", [](chunk_list& c) {
    format::lattice_chunk none = c[0];
    none.mask = 0;
    --none.y;
    c.insert(c.begin(), none);
  });
  add_changed("lattice_cell_skipped", [](chunk_list& c) { ++c[1].first_cell; });
  add_changed("lattice_cells_missing", [](chunk_list& c) { c.pop_back(); });
  add_changed("lattice_level_32", [](chunk_list& c) { c.back().level = 32; });
  add_changed("lattice_chunk_far_away", [](chunk_list& c) { c.back().x = 1 << 27; });
  add_changed("lattice_layer_far_away", [](chunk_list& c) { c.back().y = 1 << 30; });
  // Each a cell further, so that only their number is too large.
  add_changed("lattice_more_chunks_than_cells", [&](chunk_list& c) {
    c.assign(file.cell_count() + 1, {.mask = 1});
    for (std::uint32_t i = 0; i < c.size(); ++i) {
      c[i].z = static_cast<std::int32_t>(i);
      c[i].first_cell = i;
    }
  });
  bytes cut = lattice_of(shape, chunks);
  cut.resize(4 + 17);
  add("lattice_cut_in_count", cut);
  return list;
}

}  // namespace sightcell::test
