#include "sightcell/format/volume_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "importance_samples.h"
#include "sample_contents.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/set_reader.h"
#include "volume_table_writer.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using numbers = std::vector<std::uint32_t>;

// Six polygons, of which cell 1 has the last two, and three volumes, of which it has the first two.
sample_contents few_volumes() {
  sample_contents contents = tiny_contents();
  contents.volume_shape = {1.5, 2.0};
  contents.volumes = {{0, 0, 0, 0}, {-1, 0, 0, 0}, {7, -3, 2, 0}};
  contents.sets = {{0, 1, 2, 4}, {4, 5, 6, 7}};
  return contents;
}

// A row, divided into its parts.
struct split_row {
  numbers polygons, volumes;  // stored numbers; numbers of volumes
  std::size_t runs = 0;
};

split_row split(set_reader& sets, std::uint32_t cell) {
  row_parts parts;
  split_row out;
  EXPECT_EQ(sets.parts(cell, parts), status::ok);
  for (const auto& [runs, list] : {std::pair(parts.polygons, &out.polygons), std::pair(parts.volumes, &out.volumes)}) {
    std::uint64_t next = 0;
    for (const run& r : runs) {
      EXPECT_TRUE(r.count > 0 && r.first >= next) << "runs ascend and do not touch";
      next = std::uint64_t{r.first} + r.count + 1;
      for (std::uint32_t i = 0; i < r.count; ++i) list->push_back(r.first + i);
    }
  }
  out.runs = parts.polygons.size() + parts.volumes.size();
  return out;
}

numbers volumes_of(const numbers& set, std::uint32_t polygons) {
  numbers volumes;
  for (const std::uint32_t item : set) {
    if (item >= polygons) volumes.push_back(item - polygons);
  }
  return volumes;
}

// Contents of both layouts with and without a lattice of cells.
std::vector<sample_contents> several_contents() {
  std::vector<sample_contents> all{few_volumes()};
  sample_contents contents = random_contents(5, {.polygons = 900, .cells = 140, .changed = 0.1});
  add_volumes(contents, 200, 3);
  all.push_back(contents);
  put_in_order(contents, 4);
  put_on_lattice(contents);
  all.push_back(contents);
  put_in_groups(contents, 6);
  all.push_back(contents);
  return all;
}

TEST(volume_table, positions_and_boxes_come_back) {
  for (const sample_contents& contents : several_contents()) {
    const auto bytes = contents.encode();
    reader file;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    const volume_table& table = file.volumes();
    ASSERT_EQ(table.count(), contents.volumes.size());
    EXPECT_EQ(table.shape().width, contents.volume_shape.width);
    EXPECT_EQ(table.shape().height, contents.volume_shape.height);
    for (std::uint32_t volume = 0; volume < table.count(); ++volume) {
      const lattice_place& expected = contents.volumes[volume];
      lattice_place p;
      box b;
      ASSERT_TRUE(table.place(volume, p));
      EXPECT_TRUE(p.x == expected.x && p.y == expected.y && p.z == expected.z && p.level == 0) << volume;
      ASSERT_TRUE(table.volume_box(volume, b));
      const box there = box_of(contents.volume_shape, expected);
      EXPECT_TRUE(b.min == there.min && b.max == there.max) << volume;
    }
    lattice_place p{1, 2, 3, 4};
    EXPECT_FALSE(table.place(table.count(), p));
    EXPECT_EQ(p.x, 1);
  }
}

TEST(volume_table, sets_come_back_in_their_parts) {
  for (const sample_contents& contents : several_contents()) {
    const auto bytes = contents.encode();
    reader file;
    set_reader sets;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    ASSERT_EQ(sets.open(file), status::ok);
    EXPECT_EQ(sets.check(), status::ok);
    const std::uint32_t polygons = file.polygon_count();
    row_statistics expected;
    std::size_t straddling = 0;
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      numbers ids;
      ASSERT_EQ(sets.item_ids(cell, ids), status::ok);
      ASSERT_EQ(ids, contents.sets[cell]) << cell;
      ASSERT_EQ(sets.source_ids(cell, ids), status::ok);
      const numbers seen(contents.sets[cell].begin(),
                         std::lower_bound(contents.sets[cell].begin(), contents.sets[cell].end(), polygons));
      EXPECT_EQ(ids, seen) << cell;
      const split_row row = split(sets, cell);
      EXPECT_EQ(row.volumes, volumes_of(contents.sets[cell], polygons)) << cell;
      straddling += !row.polygons.empty() && !row.volumes.empty() && row.polygons.back() + 1 == polygons &&
                    row.volumes.front() == 0;
      std::span<const run> runs;
      ASSERT_EQ(sets.runs(cell, runs), status::ok);
      numbers stored;
      for (const run& r : runs) {
        for (std::uint32_t i = 0; i < r.count; ++i) stored.push_back(r.first + i);
      }
      EXPECT_EQ(stored, row.polygons) << cell;
      expected.polygons += stored.size();
      expected.runs += runs.size();
      expected.ranges += file.count_ranges(runs);
      expected.volumes += row.volumes.size();
      expected.volume_runs += row.runs - runs.size();
    }
    EXPECT_GT(straddling, 0u);
    row_statistics sums;
    ASSERT_EQ(sets.statistics(sums), status::ok);
    EXPECT_EQ(sums.polygons, expected.polygons);
    EXPECT_EQ(sums.runs, expected.runs);
    EXPECT_EQ(sums.ranges, expected.ranges);
    EXPECT_EQ(sums.volumes, expected.volumes);
    EXPECT_EQ(sums.volume_runs, expected.volume_runs);
    EXPECT_EQ(sums.volumes_per_cell() * static_cast<double>(sums.cells), static_cast<double>(sums.volumes));
  }
}

// A run from polygons into volumes is one stored run, and two ranges.
TEST(volume_table, bounds_count_volumes_as_one_more_draw) {
  const auto bytes = few_volumes().encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(get_u32(bytes, layout::header_polygon_count), 6u);
  EXPECT_EQ(file.run_bound(), 2u);  // of cell 0
  EXPECT_EQ(file.range_bound(), 2u);
  EXPECT_EQ(file.row_room(), 3u);
  sample_contents one_run = few_volumes();
  one_run.sets[0] = {};
  const auto of_one = one_run.encode();
  ASSERT_EQ(reader::open(of_one, file), status::ok);
  EXPECT_EQ(file.run_bound(), 1u);
  EXPECT_EQ(file.range_bound(), 2u) << "R + D + 1 is the most";
  EXPECT_EQ(check_all(file), status::ok);
  const auto without = tiny_contents().encode();
  ASSERT_EQ(reader::open(without, file), status::ok);
  EXPECT_EQ(file.row_room(), file.run_bound());
  EXPECT_EQ(file.volumes().count(), 0u);
}

TEST(volume_table, a_row_in_parts_takes_one_run_more) {
  sample_contents contents = few_volumes();
  contents.sets[0] = {};
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  std::vector<std::uint64_t> memory(file.codes_size() / 8 + 1);
  std::vector<std::byte> scratch(file.scratch_size());
  std::vector<run> row(file.row_room());
  const row_codes* codes = nullptr;
  ASSERT_EQ(file.make_codes(std::as_writable_bytes(std::span(memory)), codes), status::ok);
  row_parts parts;
  ASSERT_EQ(file.decode_row(1, codes, row, scratch, parts), status::ok);
  EXPECT_TRUE(parts.polygons.data() == row.data() && parts.volumes.data() == row.data() + 1);
  EXPECT_EQ(file.decode_row(1, codes, std::span(row).first(1), scratch, parts), status::capacity);
  EXPECT_TRUE(parts.polygons.empty() && parts.volumes.empty());
  std::size_t count = 7;
  ASSERT_EQ(file.decode_row(1, codes, std::span(row).first(1), scratch, count), status::ok) << "polygons alone";
  EXPECT_EQ(count, 1u);
  EXPECT_TRUE(row[0].first == 4 && row[0].count == 2);
  EXPECT_EQ(file.decode_row(2, codes, row, scratch, parts), status::argument);
}

TEST(volume_table, of_a_scene_without_polygons) {
  sample_contents contents;
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  contents.sets.resize(2);
  add_volumes(contents, 70, 9);
  contents.sets[1] = {0, 1, 2, 69};
  const auto bytes = contents.encode();
  reader file;
  set_reader sets;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  ASSERT_EQ(sets.open(file), status::ok);
  EXPECT_EQ(sets.check(), status::ok);
  EXPECT_EQ(split(sets, 1).volumes, contents.sets[1]);
  EXPECT_TRUE(split(sets, 1).polygons.empty());
  EXPECT_EQ(file.range_bound(), file.run_bound());
}

TEST(volume_table, slack_leaves_volumes_as_they_are) {
  for (const sample_contents& contents : several_contents()) {
    file_contents all = contents.view();
    all.slack = 0.5;
    std::vector<std::byte> bytes;
    ASSERT_EQ(encode(all, bytes), status::ok);
    reader file;
    set_reader sets;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    ASSERT_EQ(sets.open(file), status::ok);
    EXPECT_EQ(sets.check(), status::ok);
    std::uint64_t seen = 0, held = 0;
    const std::uint32_t polygons = file.polygon_count();
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      const numbers& exact = contents.sets[cell];
      numbers ids;
      ASSERT_EQ(sets.item_ids(cell, ids), status::ok);
      EXPECT_EQ(volumes_of(ids, polygons), volumes_of(exact, polygons)) << cell;
      EXPECT_TRUE(std::includes(ids.begin(), ids.end(), exact.begin(), exact.end())) << cell;
      const std::size_t visible = exact.size() - volumes_of(exact, polygons).size();
      EXPECT_LE(ids.size() - exact.size(), visible / 2) << "volumes are no budget";
      seen += visible;
      held += visible + ids.size() - exact.size();
    }
    const double added = static_cast<double>(held - seen) / static_cast<double>(seen);
    EXPECT_NEAR(static_cast<double>(file.facts().slack), added, 1e-6);
    EXPECT_TRUE(polygons == 6 || added > 0.1);
  }
}

// Classes are those of polygons; a file with them keeps its volumes.
TEST(volume_table, importance_is_of_polygons) {
  const sample_contents contents = several_contents()[2];
  const auto bytes = with_importance(contents.encode(), sample_class);
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(check_all(file), status::ok);
  EXPECT_EQ(file.volumes().count(), contents.volumes.size());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    std::vector<std::uint8_t> expected;
    for (const std::uint32_t item : contents.sets[cell]) {
      if (item < file.polygon_count()) expected.push_back(sample_class(cell, item));
    }
    EXPECT_EQ(classes_of(file, cell), expected) << cell;
  }
}

status outcome(const sample_contents& contents) {
  std::vector<std::byte> bytes{std::byte{42}};
  const status s = encode(contents.view(), bytes);
  EXPECT_EQ(bytes.size() == 1, s != status::ok) << "out is unchanged on failure";
  return s;
}

TEST(volume_table, volumes_that_the_writer_refuses) {
  const auto refused = [](auto change, status expected = status::argument) {
    sample_contents contents = few_volumes();
    change(contents);
    EXPECT_EQ(outcome(contents), expected);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](sample_contents&) {}, status::ok);
  refused([](sample_contents& c) { c.volumes[2] = c.volumes[0]; });
  refused([](sample_contents& c) { c.volumes[1].level = 1; });
  refused([](sample_contents& c) { c.volumes[1].x = 1 << 30; });
  refused([](sample_contents& c) { c.volumes[1].z = -(1 << 30) - 1; });
  refused([](sample_contents& c) { c.volumes[1].y = (1 << 30) - 1; });  // where floats are further apart
  refused([](sample_contents& c) { c.volume_shape.width = 0.0; });
  refused([](sample_contents& c) { c.volume_shape.height = nan; });
  refused([](sample_contents& c) { c.volume_shape.height = std::numeric_limits<double>::infinity(); });
  refused([](sample_contents& c) { c.volume_shape.width = -1.0; });
  refused([](sample_contents& c) { c.sets[0].push_back(6 + 3); });
  refused([](sample_contents& c) { c.facts.polygon_count = layout::max_polygons - 2; }, status::limit);
  refused([](sample_contents& c) { c.volumes.clear(); });  // of which some sets have members
}

TEST(volume_table, few_bytes_promise_few_volumes) {
  std::vector<std::byte> section;
  const std::vector<lattice_place> place{{3, 2, 1, 0}};
  ASSERT_EQ(put_volumes({{1.0, 1.0}, place}, section), status::ok);
  ASSERT_EQ(section.size(), 20u + 24u);
  volume_table table;
  EXPECT_EQ(volume_table::open(section, 0, table), status::ok);
  EXPECT_EQ(volume_table::open(section, layout::max_polygons - 1, table), status::ok);
  EXPECT_EQ(volume_table::open(section, layout::max_polygons, table), status::limit);
  const auto with_count = [&](std::uint32_t count) {
    set_u32(section, 16, count);
    return volume_table::open(section, 0, table);
  };
  // All of them at one position, which only a check of the whole file finds.
  EXPECT_EQ(with_count(8 * 44), status::ok);
  numbers room(table.differ_room());
  EXPECT_FALSE(table.places_differ(room));
  EXPECT_EQ(with_count(8 * 44 + 1), status::corrupt);
  EXPECT_EQ(with_count(layout::max_volumes), status::corrupt);
  EXPECT_EQ(with_count(layout::max_volumes + 1), status::limit);
  EXPECT_EQ(with_count(0), status::corrupt);
  EXPECT_EQ(table.count(), 8u * 44u) << "out is unchanged on failure";
}

}  // namespace
