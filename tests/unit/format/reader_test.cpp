#include "sightcell/format/reader.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sample_contents.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

// The memory that decode_row needs, with room in runs and bytes of scratch.
struct decoding {
  explicit decoding(const reader& file)
      : memory(file.codes_size()), runs(file.run_bound()), scratch(file.scratch_size()), stored(file.polygon_count()) {
    EXPECT_EQ(file.make_codes(memory, codes), status::ok);
  }
  std::vector<std::byte> memory;
  const row_codes* codes = nullptr;
  std::vector<run> runs;
  std::vector<std::byte> scratch;
  std::vector<std::uint32_t> stored;
};

std::uint64_t size_of(const reader& file, std::uint32_t id) {
  section_record s;
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    if (file.section(i, s) == status::ok && s.id == id) return s.size;
  }
  return 0;
}

TEST(reader, a_default_reader_is_an_empty_file) {
  const reader file;
  box b;
  EXPECT_EQ(file.cell_count(), 0u);
  EXPECT_EQ(file.cell_box(0, b), status::argument);
  EXPECT_EQ(file.settings(), "");
  EXPECT_EQ(file.chunk_count(), 0u);
  EXPECT_EQ(check_all(file), status::ok);
}

void expect_given_back(const sample_contents& contents) {
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.format_version(), 1u);
  EXPECT_EQ(file.polygon_count(), 300u);
  EXPECT_EQ(file.total_size(), bytes.size());
  EXPECT_EQ(file.facts().margin, 0.25f);
  EXPECT_EQ(file.facts().max_pixel_error, 0.5f);
  EXPECT_EQ(file.facts().confidence, 0.95f);
  EXPECT_FALSE(file.facts().repeatable);
  EXPECT_EQ(file.facts().scene_fingerprint, contents.facts.scene_fingerprint);
  EXPECT_EQ(file.settings(), contents.settings);
  ASSERT_EQ(file.draw_count(), contents.draws.size());
  for (std::uint32_t d = 0; d < file.draw_count(); ++d) {
    draw_record r;
    ASSERT_EQ(file.draw(d, r), status::ok);
    const draw_record& w = contents.draws[d];
    EXPECT_TRUE(r.node == w.node && r.mesh == w.mesh && r.primitive == w.primitive && r.instance == w.instance &&
                r.material == w.material && r.group == w.group && r.first_source == w.first_source &&
                r.polygon_count == w.polygon_count && r.first_stored == w.first_stored &&
                r.base_vertex == w.base_vertex && r.host_tag == w.host_tag && r.flags == w.flags)
        << d;
  }
  ASSERT_EQ(file.certificate_count(), file.cell_count());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    certificate_record c;
    ASSERT_EQ(file.certificate(cell, c), status::ok);
    EXPECT_EQ(c.cell, cell);
    EXPECT_EQ(c.rays, contents.certificate[cell].rays);
    EXPECT_EQ(c.misses, contents.certificate[cell].misses);
    EXPECT_EQ(c.upper_bound, contents.certificate[cell].upper_bound);
    EXPECT_EQ(c.confidence, contents.certificate[cell].confidence);
    EXPECT_EQ(c.seed, contents.certificate[cell].seed);
    box b;
    ASSERT_EQ(file.cell_box(cell, b), status::ok);
    EXPECT_EQ(b.min, contents.cells[cell].min);
    EXPECT_EQ(b.max, contents.cells[cell].max);
    status s = status::ok;
    EXPECT_EQ(decode_set(file, cell, s), contents.sets[cell]);
    EXPECT_EQ(s, status::ok);
  }
  EXPECT_EQ(check_all(file), status::ok);
}

TEST(reader, gives_back_what_was_written) {
  expect_given_back(small_contents());
}

TEST(reader, gives_back_orders_and_cells_on_a_lattice) {
  sample_contents contents = small_contents();
  put_in_order(contents, 4);
  put_on_lattice(contents);
  contents.facts.slack = 0.25f;
  expect_given_back(contents);
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.facts().slack, 0.25f);
  ASSERT_NE(file.lattice(), nullptr);
  EXPECT_EQ(file.lattice()->shape().width, 4.0);
  ASSERT_EQ(file.order_count(), contents.orders.size());
  std::vector<std::uint32_t> orders(file.order_begin(file.order_count()));
  ASSERT_EQ(file.orders(orders), status::ok);
  for (std::uint32_t number = 0; number < file.order_count(); ++number) {
    const auto& order = contents.orders[number];
    EXPECT_TRUE(std::equal(order.begin(), order.end(), orders.begin() + file.order_begin(number),
                           orders.begin() + file.order_begin(number + 1)));
  }
  std::vector<std::uint32_t> sources(file.polygon_count());
  ASSERT_EQ(file.source_of_stored(sources), status::ok);
  for (std::uint32_t d = 0; d < file.draw_count(); ++d) {
    EXPECT_EQ(file.order_of_draw(d), contents.order_of_draw[d]);
    for (std::uint32_t i = 0; i < contents.draws[d].polygon_count; ++i) {
      EXPECT_EQ(sources[contents.draws[d].first_stored + i],
                contents.draws[d].first_source + contents.orders[contents.order_of_draw[d]][i]);
    }
  }
}

// 300 polygons in draws of all sizes, two of them empty.
sample_contents grouped_contents() {
  sample_contents contents = small_contents();
  add_draws(contents, 300, 12);
  put_in_groups(contents, 4);
  return contents;
}

TEST(reader, gives_back_draw_groups) {
  const sample_contents contents = grouped_contents();
  expect_given_back(contents);
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.facts().layout, host_layout::merged);
  ASSERT_EQ(file.order_count(), contents.orders.size());
  ASSERT_EQ(file.range_unit_count(), contents.orders.size());
  std::vector<std::uint32_t> sources(300);
  ASSERT_EQ(file.source_of_stored(sources), status::ok);
  std::vector<std::uint32_t> expected;
  for (std::uint32_t group = 0; group < contents.orders.size(); ++group) {
    EXPECT_EQ(file.range_unit_begin(group), expected.size());
    std::vector<std::uint32_t> unpermuted;
    for (const draw_record& d : contents.draws) {
      for (std::uint32_t i = 0; d.group == group && i < d.polygon_count; ++i) unpermuted.push_back(d.first_source + i);
    }
    for (const std::uint32_t place : contents.orders[group]) expected.push_back(unpermuted[place]);
  }
  EXPECT_EQ(file.range_unit_begin(file.range_unit_count()), 300u);
  EXPECT_EQ(sources, expected);
}

TEST(reader, ranges_of_a_merged_file_count_groups) {
  sample_contents contents;
  add_draws(contents, 100, 10);
  for (draw_record& d : contents.draws) d.material = 0;
  contents.facts.layout = host_layout::merged;
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}};
  contents.sets.emplace_back(100);
  std::iota(contents.sets[0].begin(), contents.sets[0].end(), 0u);
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.range_unit_count(), 1u);
  EXPECT_EQ(file.range_bound(), 1u);
  EXPECT_EQ(check_all(file), status::ok);
  const run all{0, 100};
  EXPECT_EQ(file.count_ranges(std::span(&all, 1)), 1u);
}

TEST(reader, boxes_are_no_lattice) {
  const auto bytes = small_contents().encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.lattice(), nullptr);
}

TEST(reader, numbers_out_of_range_are_arguments) {
  const auto bytes = small_contents().encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  box b;
  draw_record d;
  certificate_record c;
  section_record s;
  row_record r;
  EXPECT_EQ(file.cell_box(file.cell_count(), b), status::argument);
  EXPECT_EQ(file.draw(file.draw_count(), d), status::argument);
  EXPECT_EQ(file.certificate(file.certificate_count(), c), status::argument);
  EXPECT_EQ(file.section(file.section_count(), s), status::argument);
  EXPECT_EQ(file.row(file.cell_count(), r), status::argument);
  EXPECT_EQ(file.check_chunk(file.chunk_count()), status::argument);
  EXPECT_EQ(file.order_of_draw(0xFFFFFFFFu), 0u);
  EXPECT_EQ(file.order_begin(0xFFFFFFFFu), 0u);
  std::vector<std::uint32_t> too_few(file.polygon_count() - 1);
  EXPECT_EQ(file.source_of_stored(too_few), status::argument);
  EXPECT_EQ(file.orders(too_few), status::argument);
  status outcome = status::ok;
  decode_set(file, file.cell_count(), outcome);
  EXPECT_EQ(outcome, status::argument);
}

TEST(reader, too_little_room_is_a_status) {
  const auto bytes = small_contents().encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  decoding enough(file);
  const std::span<run> fewer_runs = std::span(enough.runs).first(file.run_bound() - 1);
  const std::span<std::byte> less_scratch = std::span(enough.scratch).first(file.scratch_size() - 1);
  const std::span<std::uint32_t> fewer_stored = std::span(enough.stored).first(file.polygon_count() - 1);
  std::size_t count = 9;
  row_statistics sums;
  EXPECT_EQ(file.decode_row(0, enough.codes, fewer_runs, enough.scratch, count), status::capacity);
  EXPECT_EQ(count, 0u);
  EXPECT_EQ(file.decode_row(0, enough.codes, enough.runs, less_scratch, count), status::capacity);
  EXPECT_EQ(file.decode_row(0, nullptr, enough.runs, enough.scratch, count), status::argument);
  EXPECT_EQ(file.check(enough.codes, fewer_runs, enough.scratch, enough.stored), status::capacity);
  EXPECT_EQ(file.check(enough.codes, enough.runs, enough.scratch, fewer_stored), status::capacity);
  EXPECT_EQ(file.check(nullptr, enough.runs, enough.scratch, enough.stored), status::argument);
  EXPECT_EQ(file.statistics(enough.codes, enough.runs, less_scratch, sums), status::capacity);
  std::vector<std::byte> small(file.codes_size() - 1);
  const row_codes* codes = enough.codes;
  EXPECT_EQ(file.make_codes(small, codes), status::capacity);
  EXPECT_EQ(codes, nullptr);
}

TEST(reader, sections_follow_each_other) {
  const auto bytes = small_contents().encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  ASSERT_EQ(file.section_count(), 8u);
  std::uint64_t next = layout::header_size + 8 * layout::section_record_size;
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    section_record s;
    ASSERT_EQ(file.section(i, s), status::ok);
    EXPECT_EQ(s.offset, next);
    EXPECT_EQ(s.required, s.id != layout::section_certificate && s.id != layout::section_settings);
    next += s.size;
  }
  EXPECT_EQ(next, bytes.size());
}

TEST(reader, statistics_are_the_sums) {
  const sample_contents contents = small_contents();
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  decoding room(file);
  row_statistics sums;
  ASSERT_EQ(file.statistics(room.codes, room.runs, room.scratch, sums), status::ok);
  row_statistics expected;
  for (std::uint32_t cell = 0; cell < 67; ++cell) {
    row_record r;
    ASSERT_EQ(file.row(cell, r), status::ok);
    EXPECT_EQ(r.shared, cell == 20);
    EXPECT_TRUE(!r.delta || file.chunk_of(r.reference) == file.chunk_of(cell));
    if (!r.shared) expected.row_bytes += r.size;
    expected.delta_rows += r.delta ? 1 : 0;
    expected.polygons += contents.sets[cell].size();
    for (std::size_t i = 0; i < contents.sets[cell].size(); ++i) {
      const std::uint32_t p = contents.sets[cell][i];
      const bool follows = i > 0 && contents.sets[cell][i - 1] + 1 == p;
      expected.runs += follows ? 0 : 1;
      expected.ranges += follows && p != 120 ? 0 : 1;
      const bool begins = i == 0 || (contents.sets[cell][i - 1] < 120 && p >= 120);  // of a draw: the other has 120 on
      expected.draws += begins ? 1 : 0;
      expected.joined_ranges += begins || p - contents.sets[cell][i - 1] > row_statistics::joined_gap ? 1 : 0;
    }
  }
  EXPECT_EQ(sums.cells, 67u);
  EXPECT_EQ(sums.polygons, expected.polygons);
  EXPECT_EQ(sums.runs, expected.runs);
  EXPECT_EQ(sums.ranges, expected.ranges);
  EXPECT_EQ(sums.draws, expected.draws);
  EXPECT_EQ(sums.joined_ranges, expected.joined_ranges);
  EXPECT_EQ(sums.delta_rows, expected.delta_rows);
  EXPECT_GT(sums.delta_rows, 30u);
  EXPECT_EQ(sums.shared_rows, 1u);
  // Also of each chunk: where its rows begin, and the bytes after the last one.
  const std::uint64_t more = sums.row_bytes - expected.row_bytes;
  EXPECT_GT(sums.row_bytes, expected.row_bytes);
  EXPECT_LT(more, 67 * 2 + 2 * 16);
  EXPECT_EQ(sums.directory_bytes, 2 * layout::chunk_record_size + size_of(file, layout::section_codes));
  EXPECT_DOUBLE_EQ(sums.bits_per_visible_polygon(), 8.0 * static_cast<double>(sums.row_bytes + sums.directory_bytes) /
                                                        static_cast<double>(sums.polygons));
  EXPECT_DOUBLE_EQ(sums.runs_per_cell(), static_cast<double>(sums.runs) / 67.0);
}

TEST(reader, statistics_join_ranges_with_small_gaps) {
  sample_contents contents = small_contents();
  const auto joined_ranges = [&](const std::vector<std::uint32_t>& set) {
    for (std::vector<std::uint32_t>& of_cell : contents.sets) of_cell = set;
    const auto bytes = contents.encode();
    reader file;
    EXPECT_EQ(reader::open(bytes, file), status::ok);
    decoding room(file);
    row_statistics sums;
    EXPECT_EQ(file.statistics(room.codes, room.runs, room.scratch, sums), status::ok);
    EXPECT_DOUBLE_EQ(sums.draws_per_cell(), 2.0);  // polygons up to 119, and from 120 on
    return sums.joined_ranges_per_cell();
  };
  EXPECT_DOUBLE_EQ(joined_ranges({0, 64, 129, 130, 140}), 2.0) << "63 polygons between two ranges";
  EXPECT_DOUBLE_EQ(joined_ranges({0, 65, 129, 130, 140}), 3.0) << "64 polygons";
  EXPECT_DOUBLE_EQ(joined_ranges({119, 120}), 2.0) << "draws are not joined";
}

TEST(reader, bounds_are_reached_and_kept) {
  const sample_contents contents = random_contents(77, {.polygons = 2000, .draws = 40, .cells = 100});
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  decoding room(file);
  std::size_t most_runs = 0;
  std::uint64_t most_ranges = 0;
  for (std::uint32_t cell = 0; cell < 100; ++cell) {
    std::size_t count = 0;
    ASSERT_EQ(file.decode_row(cell, room.codes, room.runs, room.scratch, count), status::ok);
    most_runs = std::max(most_runs, count);
    most_ranges = std::max(most_ranges, file.count_ranges(std::span(room.runs).first(count)));
  }
  EXPECT_EQ(most_runs, file.run_bound());
  EXPECT_EQ(most_ranges, file.range_bound());
}

TEST(reader, a_damaged_chunk_leaves_the_others_alone) {
  const sample_contents contents = random_contents(5, {.cells = 200});
  auto bytes = contents.encode();
  const std::size_t directory = section_offset(bytes, layout::section_row_directory);
  const std::size_t chunk_start = section_offset(bytes, layout::section_rows) + get_u64(bytes, directory + 16);
  bytes[chunk_start + 5] ^= std::byte{1};
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.check_chunk(0), status::ok);
  EXPECT_EQ(file.check_chunk(1), status::checksum);
  EXPECT_EQ(file.check_chunk(2), status::ok);
  EXPECT_EQ(check_all(file), status::checksum);
}

}  // namespace
