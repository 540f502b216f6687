#include "draw_lists.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "baked_scene.h"

namespace viewer {
namespace {

namespace scene = sightcell::scene;

sightcell_draw draw_of(std::uint32_t first, std::uint32_t count) {
  sightcell_draw d{};
  d.first_source = d.first_stored = first;
  d.polygon_count = count;
  return d;
}

// Four draws of 3, 0, 4 and 2 polygons.
const std::vector<sightcell_draw> four{draw_of(0, 3), draw_of(3, 0), draw_of(3, 4), draw_of(7, 2)};

// The stored polygons of some ranges.
std::vector<std::uint32_t> polygons_of(std::span<const sightcell_range> ranges) {
  std::vector<std::uint32_t> out;
  for (const sightcell_range& r : ranges) {
    for (std::uint32_t i = 0; i < r.count; ++i) out.push_back(four[r.draw].first_stored + r.first + i);
  }
  return out;
}

struct painted {
  scene::scene s;
  std::vector<sightcell_draw> draws;
  draw_groups groups() const { return {s, draws}; }
};

painted painted_with(std::initializer_list<std::uint32_t> materials) {
  painted out;
  scene::scene& s = out.s;
  s.materials.resize(4);
  s.materials[0].alpha = scene::alpha_mode::blend;
  s.materials[2].alpha = scene::alpha_mode::mask;
  s.materials[3].double_sided = true;
  for (const std::uint32_t m : materials) out.draws.emplace_back().material = m;
  return out;
}

TEST(draw_groups, blended_surfaces_come_last_and_masked_ones_before_them) {
  const painted s = painted_with({0, 1, 2, 3, scene::no_index, 1, 0});
  const draw_groups g = s.groups();
  ASSERT_EQ(g.groups().size(), 5u);
  EXPECT_EQ(g.groups()[3].alpha, scene::alpha_mode::mask);
  EXPECT_EQ(g.groups()[4].alpha, scene::alpha_mode::blend);
  EXPECT_EQ(g.group_of_draw(0), 4u);
  EXPECT_EQ(g.group_of_draw(6), 4u);
  EXPECT_EQ(g.group_of_draw(1), g.group_of_draw(5));
  EXPECT_EQ(g.groups()[g.group_of_draw(3)].double_sided, true);
  EXPECT_EQ(g.groups()[g.group_of_draw(4)].material, 4u) << "glTF's default material lies behind the last";
  EXPECT_EQ(g.groups()[g.group_of_draw(4)].double_sided, false);
}

TEST(draw_lists, stretches_cover_the_list_once_and_neighbors_of_one_group_join) {
  const painted s = painted_with({1, 1, 1, 0});
  const draw_groups g = s.groups();
  const std::vector<sightcell_range> ranges{{0, 0, 1}, {0, 2, 1}, {2, 1, 3}, {3, 0, 2}};
  std::vector<group_stretches> out;
  make_stretches(g, parts_of(ranges), out);
  make_stretches(g, parts_of(ranges), out);  // replaces, does not add
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].counts, (std::vector<std::int32_t>{15})) << "draws 0 and 2 are drawn with one state";
  EXPECT_EQ(out[0].offsets, (std::vector<const void*>{nullptr}));
  EXPECT_EQ(out[1].counts, (std::vector<std::int32_t>{6}));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(out[1].offsets.at(0)), 15 * sizeof(std::uint32_t));
}

TEST(draw_lists, groups_that_alternate_get_their_own_stretches) {
  const painted s = painted_with({1, 0, 2, 1});
  const draw_groups g = s.groups();
  const std::vector<sightcell_range> ranges{{0, 1, 2}, {2, 0, 4}, {3, 1, 1}};
  std::vector<group_stretches> out;
  make_stretches(g, parts_of(ranges), out);
  EXPECT_EQ(out[g.group_of_draw(0)].counts, (std::vector<std::int32_t>{6, 3}));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(out[g.group_of_draw(0)].offsets.at(1)), 18 * sizeof(std::uint32_t));
  EXPECT_TRUE(out[g.group_of_draw(1)].counts.empty());
}

TEST(draw_lists, complement_is_all_the_rest) {
  const auto expect_split = [](const std::vector<sightcell_range>& ranges) {
    std::vector<std::uint32_t> both = polygons_of(ranges);
    const auto rest = polygons_of(complement(four, ranges));
    both.insert(both.end(), rest.begin(), rest.end());
    std::sort(both.begin(), both.end());
    std::vector<std::uint32_t> every(9);
    std::iota(every.begin(), every.end(), 0u);
    EXPECT_EQ(both, every);
  };
  expect_split({});
  expect_split({{0, 0, 3}, {2, 0, 4}, {3, 0, 2}});
  expect_split({{0, 1, 1}, {2, 0, 1}, {2, 3, 1}});
  expect_split({{3, 1, 1}});
  EXPECT_TRUE(complement(four, all_ranges(four)).empty());
  EXPECT_EQ(polygons_in(complement(four, {})), 9u);
}

TEST(draw_lists, draws_of_a_merged_file_are_joined_by_group) {
  std::vector<sightcell_draw> draws{draw_of(0, 3), draw_of(0, 4), draw_of(7, 2), draw_of(9, 0), draw_of(9, 5)};
  for (std::size_t i = 0; i < draws.size(); ++i) {
    draws[i].group = std::array{0u, 0u, 1u, 2u, 2u}.at(i);
    draws[i].material = 10 + draws[i].group;
  }
  const auto joined = joined_groups(draws);
  ASSERT_EQ(joined.size(), 3u);
  for (std::uint32_t group = 0; group < 3; ++group) {
    EXPECT_EQ(joined[group].polygon_count, (std::array{7u, 2u, 5u}.at(group)));
    EXPECT_EQ(joined[group].first_stored, (std::array{0u, 7u, 9u}.at(group)));
    EXPECT_EQ(joined[group].material, 10 + group);
  }
  EXPECT_TRUE(joined_groups({}).empty());
}

TEST(draw_lists, gathered_indices_follow_the_stored_numbers) {
  std::vector<std::uint32_t> stored(27);
  std::iota(stored.begin(), stored.end(), 100u);
  std::vector<std::uint32_t> out;
  gather_indices(four, std::vector<sightcell_range>{{0, 2, 1}, {3, 1, 1}}, stored, out);
  EXPECT_EQ(out, (std::vector<std::uint32_t>{106, 107, 108, 124, 125, 126}));
}

TEST(baked_scene, the_next_cell_counts_on_from_where_the_eye_is) {
  // Cell 2 is small and lies over the middle of cell 0.
  const std::vector<cell> cells{{{0, 0, 0}, {4, 4, 4}, ""}, {{9, 0, 0}, {13, 4, 4}, ""}, {{1, 1, 1}, {3, 3, 3}, ""}};
  const glm::vec3 middle_of_0(2.0f), middle_of_1(11, 2, 2), nowhere(-5.0f);
  EXPECT_EQ(cell_after(cells, 0, 0, middle_of_0, 1), 1u);
  EXPECT_EQ(cell_after(cells, 0, 2, middle_of_0, 1), 1u) << "the runtime says 2, the smaller one";
  EXPECT_EQ(cell_after(cells, 1, 1, middle_of_1, 1), 2u);
  EXPECT_EQ(cell_after(cells, 2, 2, middle_of_0, 1), 0u);
  EXPECT_EQ(cell_after(cells, 0, 0, middle_of_0, -1), 2u);
  EXPECT_EQ(cell_after(cells, 0, 1, middle_of_1, 1), 2u) << "flown to 1: on from there";
  EXPECT_EQ(cell_after(cells, 1, SIGHTCELL_NO_CELL, nowhere, 1), 2u) << "outside: on from the last one";
}

TEST(baked_scene, flags_in_words) {
  EXPECT_EQ(flags_text(0), "-");
  EXPECT_EQ(flags_text(SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE), "DRAW_ALL OUTSIDE");
  EXPECT_EQ(flags_text(31), "CHANGED DRAW_ALL OUTSIDE PENDING DAMAGED");
}

}  // namespace
}  // namespace viewer
