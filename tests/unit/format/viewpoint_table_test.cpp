#include "sightcell/format/viewpoint_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "random_source.h"
#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "viewpoint_samples.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

constexpr box unit_box{{0, 0, 0}, {1, 1, 1}};

struct walked_region {
  std::vector<region_part> parts;
  status outcome = status::ok;
};

walked_region walk(std::span<const std::byte> bytes, const box& grown = unit_box) {
  walked_region out;
  region_walk region(bytes, grown);
  for (region_part part; region.next(part);) out.parts.push_back(part);
  out.outcome = region.result();
  region_part more;
  EXPECT_FALSE(region.next(more)) << "it stays at the end";
  return out;
}

void expect_parts(const std::vector<region_part>& found, const std::vector<region_part>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_TRUE(found[i].bounds.min == expected[i].bounds.min && found[i].bounds.max == expected[i].bounds.max) << i;
    EXPECT_EQ(found[i].inside, expected[i].inside) << i;
  }
}

double volume_of(const box& b) {
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) volume *= static_cast<double>(b.max[axis] - b.min[axis]);
  return volume;
}

// Boxes, cells on a lattice, and no cells.
std::vector<sample_contents> several_contents() {
  std::vector<sample_contents> all{tiny_contents()};
  sample_contents contents = random_contents(5, {.polygons = 100, .cells = 140, .overlapping = true});
  all.push_back(contents);
  put_on_lattice(contents);
  all.push_back(contents);
  for (sample_contents& c : all) add_viewpoints(c, 1);
  return all;
}

TEST(viewpoint_table, records_come_back) {
  for (const sample_contents& contents : several_contents()) {
    const auto bytes = contents.encode();
    reader file;
    ASSERT_EQ(reader::open(bytes, file), status::ok);
    EXPECT_EQ(check_all(file), status::ok);
    const viewpoint_table& table = file.viewpoints();
    EXPECT_TRUE(table.exists());
    EXPECT_EQ(table.player_radius(), 0.05f);
    ASSERT_EQ(file.cell_count(), contents.viewpoints.size());
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      const viewpoint_record& given = contents.viewpoints[cell];
      EXPECT_EQ(table.valid_share(cell), given.valid_share) << cell;
      EXPECT_EQ(static_cast<double>(table.outside_share(cell)), given.outside_share) << cell;
      const auto region = table.region_bytes(cell);
      EXPECT_TRUE(std::equal(region.begin(), region.end(), given.region.begin(), given.region.end())) << cell;
      const box grown = grown_box(contents.cells[cell], contents.facts.margin);
      std::vector<region_part> parts;
      EXPECT_EQ(table.parts(cell, grown, [&](const region_part& part) { parts.push_back(part); }), status::ok);
      expect_parts(parts, make_region(1 + cell, grown).parts);
    }
    const auto none = [](const region_part&) { FAIL() << "no such cell"; };
    EXPECT_EQ(table.parts(file.cell_count(), unit_box, none), status::argument);
    EXPECT_TRUE(table.region_bytes(file.cell_count()).empty());
  }
}

TEST(viewpoint_table, a_file_may_have_none) {
  const auto bytes = small_contents().encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_FALSE(file.viewpoints().exists());
  EXPECT_EQ(file.viewpoints().player_radius(), 0.0f);
  EXPECT_EQ(file.viewpoints().valid_share(0), 1.0f);
  EXPECT_EQ(file.viewpoints().outside_share(0), 0.0f);
  EXPECT_TRUE(file.viewpoints().region_bytes(0).empty());
  EXPECT_EQ(file.viewpoints().parts(0, unit_box, [](const region_part&) {}), status::argument);
}

TEST(viewpoint_table, a_box_grows_on_all_sides) {
  const box grown = grown_box({{0, 1, 2}, {3, 4, 5}}, 0.25f);
  EXPECT_EQ(grown.min, (std::array<float, 3>{-0.25f, 0.75f, 1.75f}));
  EXPECT_EQ(grown.max, (std::array<float, 3>{3.25f, 4.25f, 5.25f}));
}

// Of equal sides the first one is halved, and the lower half comes first.
TEST(viewpoint_table, splits_halve_the_longest_side) {
  const box grown{{0, -1, 0}, {2, 1, 1}};
  const walked_region found = walk(packed_nodes("2201201"), grown);  // x, then y of both halves
  EXPECT_EQ(found.outcome, status::ok);
  expect_parts(found.parts, {{{{0, -1, 0}, {1, 0, 1}}, false},
                             {{{0, 0, 0}, {1, 1, 1}}, true},
                             {{{1, -1, 0}, {2, 0, 1}}, false},
                             {{{1, 0, 0}, {2, 1, 1}}, true}});
  const walked_region whole = walk({}, grown);
  EXPECT_EQ(whole.outcome, status::ok);
  expect_parts(whole.parts, {{grown, true}});
}

TEST(viewpoint_table, trees_that_are_none) {
  const auto outcome = [](std::string_view nodes) { return walk(packed_nodes(nodes)).outcome; };
  EXPECT_EQ(outcome("201"), status::ok);
  EXPECT_EQ(outcome("211"), status::ok);
  EXPECT_EQ(outcome("1"), status::corrupt) << "the root is a leaf";
  EXPECT_EQ(outcome("0"), status::corrupt);
  EXPECT_EQ(outcome("200"), status::corrupt) << "nothing is inside";
  EXPECT_EQ(outcome("231"), status::corrupt) << "no such node";
  EXPECT_EQ(outcome("3"), status::corrupt);
  EXPECT_EQ(outcome("2222"), status::corrupt) << "nodes are missing";
  EXPECT_EQ(outcome("20100000"), status::corrupt) << "a byte is left";
  EXPECT_EQ(outcome("2011"), status::corrupt) << "bits are left";
  EXPECT_EQ(outcome("20011"), status::corrupt) << "a node is left";
  for (const std::string first : {"0", "1"}) {
    const auto chain = [&](std::size_t depth, bool lower) {
      std::string nodes;
      for (std::size_t i = 0; i < depth; ++i) nodes += lower ? "2" : "2" + first;
      nodes += '1';
      return lower ? nodes + std::string(depth, first[0]) : nodes;
    };
    for (const bool lower : {false, true}) {
      EXPECT_EQ(outcome(chain(18, lower)), status::ok);
      EXPECT_EQ(outcome(chain(19, lower)), status::corrupt) << "too deep";
      EXPECT_EQ(outcome(chain(1000, lower)), status::corrupt);
    }
  }
  EXPECT_EQ(walk(std::vector<std::byte>(layout::max_region_size + 1, std::byte{0xAA})).outcome, status::limit);
}

// Where two floats meet, a side has no middle.
TEST(viewpoint_table, splits_between_floats) {
  const auto nodes = packed_nodes("201");
  EXPECT_EQ(walk(nodes, {{16777216, 0, 0}, {16777218, 1, 1}}).outcome, status::corrupt);
  EXPECT_EQ(walk(nodes, {{16777216, 0, 0}, {16777224, 1, 1}}).outcome, status::ok);
  EXPECT_EQ(walk(nodes, {{2e38f, 0, 0}, {3e38f, 1, 1}}).outcome, status::corrupt);
}

// All leaves at depth 17: 262,143 nodes in 65,536 bytes.
TEST(viewpoint_table, a_region_as_large_as_it_may_be) {
  std::string nodes;
  const auto grow = [&](auto& self, int depth) -> void {
    nodes += depth == 17 ? '1' : '2';
    for (int half = 0; half < 2 && depth < 17; ++half) self(self, depth + 1);
  };
  grow(grow, 0);
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 4);
  contents.viewpoints[0].region = packed_nodes(nodes);
  ASSERT_EQ(contents.viewpoints[0].region.size(), layout::max_region_size);
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(check_all(file), status::ok);
  std::size_t parts = 0;
  EXPECT_EQ(file.viewpoints().parts(0, unit_box, [&](const region_part&) { ++parts; }), status::ok);
  EXPECT_EQ(parts, 131072u);
  contents.viewpoints[0].region.emplace_back();
  std::vector<std::byte> none;
  EXPECT_EQ(encode(contents.view(), none), status::limit);
}

// Parts are inside the box; those of a sound tree fill it.
TEST(viewpoint_table, hostile_trees) {
  random_source random(3);
  std::size_t sound = 0;
  for (std::uint32_t seed = 0; seed < 4000; ++seed) {
    auto bytes = make_region(seed, unit_box).bytes;
    for (std::uint32_t change = random.below(3); change > 0 && !bytes.empty(); --change)
      bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] ^= static_cast<std::byte>(1u << random.below(8));
    if (random.below(8) == 0) bytes.resize(random.below(8));
    const walked_region found = walk(bytes);
    ASSERT_TRUE(found.outcome == status::ok || found.outcome == status::corrupt);
    ASSERT_LE(found.parts.size(), 4 * bytes.size() + 1);
    double volume = 0.0;
    for (const region_part& part : found.parts) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_TRUE(part.bounds.min[axis] >= 0 && part.bounds.max[axis] <= 1 &&
                    part.bounds.min[axis] < part.bounds.max[axis]);
      volume += volume_of(part.bounds);
    }
    if (found.outcome != status::ok) continue;
    EXPECT_DOUBLE_EQ(volume, 1.0) << seed;
    ++sound;
  }
  EXPECT_GT(sound, 1000u);
  EXPECT_LT(sound, 3800u);
}

status outcome(const sample_contents& contents) {
  std::vector<std::byte> bytes{std::byte{42}};
  const status s = encode(contents.view(), bytes);
  EXPECT_EQ(bytes.size() == 1, s != status::ok) << "out is unchanged on failure";
  return s;
}

TEST(viewpoint_table, records_that_the_writer_refuses) {
  const auto refused = [](auto change, status expected = status::argument) {
    sample_contents contents = tiny_contents();
    add_viewpoints(contents, 4);  // cell 0: the whole box
    change(contents);
    EXPECT_EQ(outcome(contents), expected);
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinite = std::numeric_limits<float>::infinity();
  refused([](sample_contents&) {}, status::ok);
  refused([](sample_contents& c) { c.viewpoints.pop_back(); });
  refused([](sample_contents& c) { c.viewpoints.push_back({.cell = 2, .region = {}}); });
  refused([](sample_contents& c) { std::swap(c.viewpoints[0], c.viewpoints[1]); });
  for (const float radius : {0.0f, -1.0f, nan, infinite})
    refused([&](sample_contents& c) { c.player_radius = radius; });
  for (const float share : {0.0f, -0.5f, 1.5f, nan})
    refused([&](sample_contents& c) { c.viewpoints[0].valid_share = share; });
  for (const double share : {-0.5, 1.5, static_cast<double>(nan)})
    refused([&](sample_contents& c) { c.viewpoints[1].outside_share = share; });
  refused([](sample_contents& c) { c.viewpoints[0].outside_share = 0.5; });
  refused([](sample_contents& c) { c.viewpoints[1].outside_share = 1.0; }, status::ok);
  refused([](sample_contents& c) { c.viewpoints[1].region = packed_nodes("200"); });
  refused([](sample_contents& c) { c.viewpoints[1].region = packed_nodes("2010000"); });
  refused([](sample_contents& c) { c.viewpoints[1].region.resize(layout::max_region_size + 1); }, status::limit);
  // A tree over the grown box, which has more floats than the cell.
  refused([](sample_contents& c) { c.viewpoints[1].region = packed_nodes("201"); }, status::ok);
  refused([](sample_contents& c) {
    c.viewpoints[1].region = packed_nodes("201");
    c.facts.margin = 0.0f;
    c.cells[1] = {{16777216, 0, 0}, {16777218, 1, 1}};
  });
}

TEST(viewpoint_table, the_share_outside_is_rounded_up) {
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 4);
  contents.viewpoints[1].outside_share = std::nextafter(0.25, 1.0);
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  EXPECT_EQ(file.viewpoints().outside_share(1), std::nextafter(0.25f, 1.0f));
}

// Values are checked again when they are read again.
TEST(viewpoint_table, bytes_that_change_later) {
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 5);
  auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  ASSERT_EQ(file.viewpoints().parts(0, unit_box, [](const region_part&) {}), status::ok);
  const std::uint64_t size = get_u64(bytes, section_place(bytes, layout::section_viewpoints) + 16);
  for (std::uint64_t i = layout::viewpoints_head_size + 24; i < size; ++i)
    bytes[section_offset(bytes, layout::section_viewpoints) + i] = std::byte{0xFF};
  EXPECT_NE(file.viewpoints().parts(0, unit_box, [](const region_part&) {}), status::ok);
  file_parts parts;
  EXPECT_NE(take_apart(file, parts), status::ok);
}

}  // namespace
