// Indirect draws of a view: the polygons of its ranges, and those of small gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "loaded_file.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::test;
using sightcell::format::host_layout;

std::vector<sightcell_command> commands_of(const test_view& view, std::uint32_t min_gap) {
  std::size_t count = 0;
  static_cast<void>(sightcell_view_commands(view.get(), min_gap, nullptr, sizeof(sightcell_command), 0, &count));
  std::vector<sightcell_command> commands(count);
  EXPECT_EQ(sightcell_view_commands(view.get(), min_gap, commands.data(), sizeof(sightcell_command), count, &count),
            SIGHTCELL_OK);
  return commands;
}

// The ranges that commands draw.
std::vector<sightcell_range> ranges_of(const std::vector<sightcell_command>& commands,
                                       const sample_contents& contents) {
  const bool merged = contents.facts.layout == host_layout::merged;
  std::vector<std::uint32_t> begins;  // in the index buffer of a command
  std::vector<std::uint32_t> base_vertices;
  for (const auto& d : contents.draws) {
    if (merged && d.group < begins.size()) continue;
    begins.push_back(merged ? d.first_stored : 0);
    base_vertices.push_back(merged ? 0 : d.base_vertex);
  }
  std::vector<sightcell_range> ranges;
  for (const sightcell_command& c : commands) {
    EXPECT_EQ(c.instance_count, 1u);
    EXPECT_EQ(c.index_count % 3 + c.first_index % 3, 0u);
    EXPECT_EQ(c.base_vertex, base_vertices.at(c.first_instance));
    ranges.push_back({c.first_instance, c.first_index / 3 - begins.at(c.first_instance), c.index_count / 3});
  }
  return ranges;
}

// Ranges whose gaps inside a draw are smaller than min_gap, joined one polygon at a time.
std::vector<sightcell_range> joined(const std::vector<sightcell_range>& ranges, std::uint32_t min_gap) {
  std::vector<sightcell_range> out;
  for (const sightcell_range& r : ranges) {
    const bool near = !out.empty() && out.back().draw == r.draw &&
                      r.first < std::uint64_t{out.back().first} + out.back().count + min_gap;
    if (near)
      out.back().count = r.first + r.count - out.back().first;
    else
      out.push_back(r);
  }
  return out;
}

bool equal(const std::vector<sightcell_range>& a, const std::vector<sightcell_range>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.draw == y.draw && x.first == y.first && x.count == y.count;
  });
}

sample_contents contents_in(host_layout layout, std::uint32_t seed) {
  sample_contents contents = random_contents(seed, {.polygons = 700, .draws = 20, .cells = 40, .visible = 0.4});
  std::uint32_t vertices = 5;
  for (auto& d : contents.draws) d.base_vertex = vertices += d.polygon_count + 2;
  if (layout == host_layout::merged) put_in_groups(contents, 6);
  return contents;
}

TEST(commands, are_the_ranges_and_what_small_gaps_hold) {
  std::size_t most_saved = 0;
  for (const host_layout layout : {host_layout::instanced, host_layout::merged}) {
    const sample_contents contents = contents_in(layout, 5);
    const loaded_file file(contents);
    test_view view(file.db());
    EXPECT_TRUE(commands_of(view, 3).empty()) << "before the first move";
    for (const auto& box : contents.cells) {
      view.move((box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2, (box.min[2] + box.max[2]) / 2);
      for (const std::uint32_t gap : {0u, 1u, 2u, 5u, 0xFFFFFFFFu}) {
        const auto found = ranges_of(commands_of(view, gap), contents);
        EXPECT_TRUE(equal(found, joined(view.ranges(), gap))) << gap;
        most_saved = std::max(most_saved, view.ranges().size() - found.size());
      }
    }
    view.move(1000, 0, 0);
    EXPECT_TRUE(equal(ranges_of(commands_of(view, 9), contents), view.ranges())) << "everything";
  }
  EXPECT_GT(most_saved, 10u);
}

TEST(commands, are_written_at_any_stride_and_alignment) {
  const sample_contents contents = contents_in(host_layout::instanced, 6);
  const loaded_file file(contents);
  test_view view(file.db());
  const auto& box = contents.cells[3];
  view.move((box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2, (box.min[2] + box.max[2]) / 2);
  const auto expected = commands_of(view, 2);
  constexpr std::size_t stride = 29;
  std::vector<unsigned char> room(expected.size() * stride + 1, 0xAB);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_view_commands(view.get(), 2, room.data() + 1, stride, expected.size(), &count), SIGHTCELL_OK);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(std::memcmp(room.data() + 1 + i * stride, &expected[i], sizeof(sightcell_command)), 0);
    for (std::size_t k = sizeof(sightcell_command); k < stride; ++k) EXPECT_EQ(room[1 + i * stride + k], 0xAB);
  }
}

TEST(commands, without_room_nothing_is_written) {
  const sample_contents contents = contents_in(host_layout::instanced, 7);
  const loaded_file file(contents);
  test_view view(file.db());
  view.move(1000, 0, 0);
  const std::size_t need = commands_of(view, 0).size();
  std::vector<sightcell_command> room(need, {42, 42, 42, 42, 42});
  std::size_t count = 0;
  constexpr std::size_t size = sizeof(sightcell_command);
  EXPECT_EQ(sightcell_view_commands(view.get(), 0, room.data(), size, need - 1, &count), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(count, need);
  for (const auto& c : room) EXPECT_EQ(c.index_count, 42u);
  EXPECT_EQ(sightcell_view_commands(view.get(), 0, room.data(), size - 1, need, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_commands(view.get(), 0, nullptr, size, need, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_commands(view.get(), 0, room.data(), size, need, nullptr), SIGHTCELL_ERR_ARGUMENT);
}

}  // namespace
