#include "sightcell/format/writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

status outcome(const sample_contents& contents) {
  std::vector<std::byte> bytes{std::byte{42}};
  const status s = encode(contents.view(), bytes);
  if (s != status::ok) {
    EXPECT_EQ(bytes.size(), 1u) << "out is left alone on failure";
  }
  return s;
}

void expect_round_trip(const sample_contents& contents) {
  const auto bytes = contents.encode();
  EXPECT_EQ(bytes, contents.encode()) << "same contents, same bytes";
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  std::vector<run> out(file.run_bound());
  std::vector<run> scratch(file.run_bound());
  ASSERT_EQ(file.check(out, scratch), status::ok);
  ASSERT_EQ(file.cell_count(), contents.sets.size());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    status s = status::ok;
    ASSERT_EQ(decode_set(file, cell, s), contents.sets[cell]) << cell;
  }
}

TEST(writer, random_sets_come_back) {
  std::uint32_t seed = 1;
  for (const std::uint32_t polygons : {1u, 7u, 300u, 5000u}) {
    for (const std::uint32_t cells : {1u, 63u, 64u, 65u, 200u}) {
      for (const double changed : {0.02, 0.6}) {
        expect_round_trip(random_contents(seed++, {.polygons = polygons, .cells = cells, .changed = changed}));
      }
    }
  }
}

// Sets of contents that come one at a time, like those of a bake.
struct asked_sets {
  explicit asked_sets(const sample_contents& from) : contents(from), changed(from.view()) {
    changed.cell_sets.get = [this](std::uint32_t cell, std::vector<std::uint32_t>& set) {
      EXPECT_TRUE(set.empty()) << cell;
      EXPECT_EQ(cell, asked++);
      if (cell == failing) return status::io;
      set = contents.sets[cell];
      return status::ok;
    };
  }
  const sample_contents& contents;
  file_contents changed;
  std::uint32_t asked = 0;
  std::uint32_t failing = 0xFFFFFFFFu;
};

TEST(writer, asks_for_every_set_once_and_in_order) {
  const auto contents = random_contents(9, {.polygons = 300, .cells = 150});
  asked_sets sets(contents);
  std::vector<std::byte> bytes;
  ASSERT_EQ(encode(sets.changed, bytes), status::ok);
  EXPECT_EQ(sets.asked, 150u);
  EXPECT_EQ(bytes, contents.encode());
}

TEST(writer, ends_with_what_a_set_says) {
  const auto contents = random_contents(9, {.polygons = 300, .cells = 150});
  asked_sets sets(contents);
  sets.failing = 70;
  std::vector<std::byte> bytes{std::byte{42}};
  EXPECT_EQ(encode(sets.changed, bytes), status::io);
  EXPECT_EQ(bytes.size(), 1u) << "out is left alone on failure";
  EXPECT_EQ(sets.asked, 71u);
  sets.changed.cell_sets.get = nullptr;
  EXPECT_EQ(encode(sets.changed, bytes), status::argument);
}

TEST(writer, empty_things) {
  expect_round_trip({});
  sample_contents no_cells;
  add_draws(no_cells, 10, 3);
  expect_round_trip(no_cells);
  sample_contents no_polygons;
  no_polygons.cells.push_back({{0, 0, 0}, {1, 1, 1}});
  no_polygons.sets.emplace_back();
  expect_round_trip(no_polygons);
}

TEST(writer, difference_rows_pay_where_neighbors_are_alike) {
  const auto alike = random_contents(6, {.polygons = 20000, .cells = 64, .changed = 0.03}).encode();
  auto contents = random_contents(6, {.polygons = 20000, .cells = 64, .changed = 0.03});
  reader file;
  ASSERT_EQ(reader::open(alike, file), status::ok);
  std::vector<run> out(file.run_bound());
  std::vector<run> scratch(file.run_bound());
  row_statistics sums;
  ASSERT_EQ(file.statistics(out, scratch, sums), status::ok);
  EXPECT_GT(sums.delta_row_percent(), 40.0);
  EXPECT_LT(sums.row_bytes, sums.runs * 2 / 2);  // own rows cost at least two bytes for every run
}

TEST(writer, contents_that_contradict_themselves) {
  const auto refused = [](auto change, status expected = status::argument) {
    sample_contents contents = small_contents();
    change(contents);
    EXPECT_EQ(outcome(contents), expected);
  };
  refused([](sample_contents& c) { c.sets[3] = {5, 4}; });
  refused([](sample_contents& c) { c.sets[3] = {5, 5}; });
  refused([](sample_contents& c) { c.sets[3] = {300}; });
  refused([](sample_contents& c) { c.sets.pop_back(); });
  refused([](sample_contents& c) { c.cells.pop_back(); });
  refused([](sample_contents& c) { c.certificate.pop_back(); });
  refused([](sample_contents& c) { c.certificate[1].cell = 0; });
  refused([](sample_contents& c) { c.certificate[1].misses = c.certificate[1].rays + 1; });
  refused([](sample_contents& c) { c.certificate[1].upper_bound = 1.5; });
  refused([](sample_contents& c) { c.certificate[1].confidence = std::nan(""); });
  refused([](sample_contents& c) { c.draws[2].polygon_count = 179; });
  refused([](sample_contents& c) { c.draws[2].first_source = 121; });
  refused([](sample_contents& c) { c.draws[2].first_stored = 121; });
  refused([](sample_contents& c) { c.draws[0].polygon_count = 0xFFFFFFFFu; });
  refused([](sample_contents& c) { c.draws[0].group = 1; });
  refused([](sample_contents& c) { c.cells[0].max[1] = c.cells[0].min[1]; });
  refused([](sample_contents& c) { c.cells[0].max[1] = std::numeric_limits<float>::infinity(); });
  refused([](sample_contents& c) { c.cells[0].min[0] = std::nanf(""); });
  refused([](sample_contents& c) { c.facts.margin = -0.1f; });
  refused([](sample_contents& c) { c.facts.max_pixel_error = 1.1f; });
  refused([](sample_contents& c) { c.facts.confidence = std::nanf(""); });
  refused([](sample_contents& c) { c.facts.layout = host_layout::merged; });
  refused([](sample_contents& c) { c.facts.margin = 2.0e6f; }, status::limit);
  refused([](sample_contents& c) { c.facts.polygon_count = 0xFFFFFFFFu; }, status::limit);
  refused([](sample_contents& c) { c.settings.assign(layout::max_settings_size + 1, ' '); }, status::limit);
  refused([](sample_contents& c) { c.settings.assign(layout::max_settings_size, ' '); }, status::ok);
}

TEST(writer, the_highest_polygon_number) {
  sample_contents contents;
  contents.facts.polygon_count = layout::max_polygons;
  contents.draws.push_back({.polygon_count = layout::max_polygons});
  contents.cells.push_back({{0, 0, 0}, {1, 1, 1}});
  contents.sets.push_back({0, 2, layout::max_polygons - 1});
  expect_round_trip(contents);
}

}  // namespace
