// Named groups: the names in the scene, and what a view omits when the host hides one.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "loaded_file.h"

namespace {

using namespace sightcell::test;
using sightcell::format::draw_record;
using sightcell::format::host_layout;
using sightcell::format::no_named_group;
using numbers = std::vector<std::uint32_t>;

// Every third draw, or draw group, is in none. One name has no draw.
sample_contents contents_in(host_layout layout) {
  sample_contents contents = random_contents(21, {.polygons = 700, .draws = 24, .cells = 60, .visible = 0.4});
  if (layout == host_layout::merged) put_in_groups(contents, 6);
  contents.named_groups = {"door", "nothing", "lamp", "T\xC3\xBCr"};
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    draw_record& d = contents.draws[i];
    const std::uint32_t unit = layout == host_layout::merged ? d.group : static_cast<std::uint32_t>(i);
    d.named_group = unit % 3 == 0 ? no_named_group : unit % 4 == 1 ? 3 : unit % 2 * 2;
  }
  return contents;
}

// Source ids of a set without those of hidden groups.
numbers without(const sample_contents& contents, const numbers& set, const std::set<std::uint32_t>& hidden) {
  numbers left;
  for (const std::uint32_t polygon : set) {
    const auto of = std::find_if(contents.draws.begin(), contents.draws.end(), [&](const draw_record& d) {
      return polygon >= d.first_source && polygon - d.first_source < d.polygon_count;
    });
    if (!hidden.contains(of->named_group)) left.push_back(polygon);
  }
  return left;
}

void show(const test_view& view, std::uint32_t group, bool shown) {
  EXPECT_EQ(sightcell_view_show_named_group(view.get(), group, shown ? 1 : 0), SIGHTCELL_OK);
}

// All outputs return the same polygons: those of a set without the hidden ones.
void expect_shows(const test_view& view, const loaded_file& file, const sample_contents& contents,
                  const sightcell_frame& frame, const numbers& set, const std::set<std::uint32_t>& hidden) {
  const numbers expected = without(contents, set, hidden);
  numbers polygons = view.polygons();
  const numbers in_order = polygons;
  std::sort(polygons.begin(), polygons.end());
  EXPECT_EQ(polygons, expected);
  EXPECT_EQ(frame.polygon_count, expected.size());
  const auto ranges = view.ranges();
  EXPECT_LE(ranges.size(), file.info().range_bound);
  const numbers stored = polygons_of(ranges, contents);
  numbers source(contents.facts.polygon_count);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_order(file.db(), source.data(), source.size(), &count), SIGHTCELL_OK);
  numbers from_ranges;
  for (const std::uint32_t s : stored) from_ranges.push_back(source[s]);
  EXPECT_EQ(from_ranges, in_order);
  const numbers indices = view.indices(all_polygons(3 * contents.facts.polygon_count));
  ASSERT_EQ(indices.size(), 3 * stored.size());
  for (std::size_t i = 0; i < indices.size(); ++i) ASSERT_EQ(indices[i], 3 * stored[i / 3] + i % 3);
  std::vector<sightcell_command> commands(ranges.size());
  ASSERT_EQ(sightcell_view_commands(view.get(), 0, commands.data(), sizeof(sightcell_command), commands.size(), &count),
            SIGHTCELL_OK);
  ASSERT_EQ(count, ranges.size());
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_TRUE(commands[i].first_instance == ranges[i].draw && commands[i].index_count == 3 * ranges[i].count);
  }
  std::vector<std::uint64_t> bits((contents.draws.size() + 63) / 64);
  ASSERT_EQ(sightcell_view_objects(view.get(), bits.data(), bits.size()), SIGHTCELL_OK);
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    const draw_record& d = contents.draws[i];
    const auto first = std::lower_bound(expected.begin(), expected.end(), d.first_source);
    const bool seen = first != expected.end() && *first - d.first_source < d.polygon_count;
    const bool bit = (bits[i / 64] >> i % 64 & 1) != 0;
    if (d.polygon_count > 0) {
      EXPECT_EQ(bit, seen) << i;
    } else if (hidden.contains(d.named_group)) {
      EXPECT_FALSE(bit) << i;
    }
  }
}

class named_groups : public testing::TestWithParam<host_layout> {};
INSTANTIATE_TEST_SUITE_P(layouts, named_groups, testing::Values(host_layout::instanced, host_layout::merged));

TEST_P(named_groups, are_those_of_the_file) {
  const sample_contents contents = contents_in(GetParam());
  const loaded_file file(contents);
  ASSERT_EQ(sightcell_db_named_group_count(file.db()), 4u);
  for (std::uint32_t group = 0; group < 4; ++group) {
    std::string name(20, '?');
    std::size_t count = 0;
    EXPECT_EQ(sightcell_db_named_group_name(file.db(), group, name.data(), name.size(), &count), SIGHTCELL_OK);
    name.resize(count);
    EXPECT_EQ(name, contents.named_groups[group]);
    EXPECT_EQ(sightcell_db_named_group_name(file.db(), group, name.data(), count - 1, &count), SIGHTCELL_ERR_CAPACITY);
    EXPECT_EQ(count, name.size());
    std::uint32_t found = 9;
    EXPECT_EQ(sightcell_db_find_named_group(file.db(), name.c_str(), &found), SIGHTCELL_OK);
    EXPECT_EQ(found, group);
  }
  std::uint32_t found = 0;
  EXPECT_EQ(sightcell_db_find_named_group(file.db(), "doo", &found), SIGHTCELL_OK);
  EXPECT_EQ(found, SIGHTCELL_NO_NAMED_GROUP);
  numbers groups(contents.draws.size());
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_named_groups_of_draws(file.db(), groups.data(), groups.size(), &count), SIGHTCELL_OK);
  ASSERT_EQ(count, groups.size());
  for (std::size_t i = 0; i < groups.size(); ++i) EXPECT_EQ(groups[i], contents.draws[i].named_group);
}

TEST_P(named_groups, that_are_hidden_are_in_no_output) {
  const sample_contents contents = contents_in(GetParam());
  const loaded_file file(contents);
  test_view view(file.db());
  const numbers all = all_polygons(contents.facts.polygon_count);
  std::size_t hidden_polygons = 0;
  std::set<std::uint32_t> hidden;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const std::uint32_t group = cell % 4;
    const bool now_shown = hidden.erase(group) > 0;
    if (!now_shown) hidden.insert(group);
    show(view, group, now_shown);
    const auto& b = contents.cells[cell];
    const sightcell_frame frame = view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f);
    ASSERT_EQ(frame.cell, cell);
    expect_shows(view, file, contents, frame, contents.sets[cell], hidden);
    hidden_polygons += contents.sets[cell].size() - frame.polygon_count;
    if (cell % 5 == 0) {
      const sightcell_frame outside = view.move(1000, 0, 0);
      EXPECT_NE(outside.flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
      expect_shows(view, file, contents, outside, all, hidden);
    }
  }
  EXPECT_GT(hidden_polygons, 500u);
}

TEST_P(named_groups, change_where_the_eye_stays) {
  const sample_contents contents = contents_in(GetParam());
  const loaded_file file(contents);
  test_view view(file.db());
  const auto& b = contents.cells[17];
  const auto stay = [&] { return view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f); };
  const sightcell_frame before = stay();
  const numbers with = polygons_of(view.ranges(), contents);
  show(view, 3, true);  // it is shown already
  EXPECT_EQ(stay().flags, 0u);
  show(view, 3, false);
  EXPECT_EQ(view.polygons().size(), with.size()) << "not before the next move";
  const sightcell_frame after = stay();
  EXPECT_EQ(after.flags, SIGHTCELL_FRAME_CHANGED);
  EXPECT_EQ(after.revision, before.revision + 1);
  std::vector<sightcell_range> added(100);
  std::vector<sightcell_range> removed(100);
  std::size_t added_count = 0;
  std::size_t removed_count = 0;
  ASSERT_EQ(sightcell_view_changes(view.get(), before.revision, added.data(), 100, &added_count, removed.data(), 100,
                                   &removed_count),
            SIGHTCELL_OK);
  EXPECT_EQ(added_count, 0u);
  removed.resize(removed_count);
  numbers gone;
  const numbers left = polygons_of(view.ranges(), contents);
  std::set_difference(with.begin(), with.end(), left.begin(), left.end(), std::back_inserter(gone));
  EXPECT_FALSE(gone.empty());
  EXPECT_EQ(polygons_of(removed, contents), gone);
  EXPECT_EQ(stay().flags, 0u) << "and it stays so";
  show(view, 1, false);
  EXPECT_EQ(stay().flags, 0u) << "a name without draws";
  show(view, 3, true);
  show(view, 3, false);
  EXPECT_EQ(stay().flags, 0u) << "there and back";
  show(view, 3, true);
  EXPECT_EQ(stay().flags, SIGHTCELL_FRAME_CHANGED);
  EXPECT_EQ(polygons_of(view.ranges(), contents), with);
}

// For two cells at once, and outside by the nearest cell.
TEST_P(named_groups, are_hidden_however_the_view_moves) {
  const sample_contents contents = contents_in(GetParam());
  const loaded_file file(contents);
  test_view view(file.db());
  show(view, 3, false);
  const auto& a = contents.cells[1];
  const float min[3] = {a.min[0] + 0.5f, a.min[1] + 0.5f, a.min[2] + 0.5f};
  const float max[3] = {a.min[0] + 1.5f, a.min[1] + 0.6f, a.min[2] + 0.6f};
  sightcell_frame frame;
  const auto both = [&](const std::set<std::uint32_t>& hidden) {
    numbers together;
    const auto next = std::find_if(contents.cells.begin(), contents.cells.end(), [&](const auto& c) {
      return c.min[0] == a.max[0] && c.min[1] == a.min[1] && c.min[2] == a.min[2];
    });
    const numbers& x = contents.sets[1];
    const numbers& y = contents.sets[static_cast<std::size_t>(next - contents.cells.begin())];
    std::set_union(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(together));
    return without(contents, together, hidden);
  };
  for (const bool shown : {false, true, false}) {
    show(view, 0, shown);
    ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
    numbers polygons = view.polygons();
    std::sort(polygons.begin(), polygons.end());
    const numbers seen = both(shown ? std::set{3u} : std::set{0u, 3u});
    EXPECT_TRUE(std::includes(polygons.begin(), polygons.end(), seen.begin(), seen.end()));
    EXPECT_EQ(without(contents, polygons, shown ? std::set{3u} : std::set{0u, 3u}), polygons);
  }
  for (const bool shown : {true, false}) {  // where the set is everything before and after
    show(view, 0, shown);
    frame = view.move(1000, 0, 0);
    expect_shows(view, file, contents, frame, all_polygons(contents.facts.polygon_count),
                 shown ? std::set{3u} : std::set{0u, 3u});
  }
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, 1e9f), SIGHTCELL_OK);
  for (const bool shown : {false, true, false}) {
    show(view, 2, shown);
    frame = view.move(-5, -5, -5);
    EXPECT_EQ(frame.flags & (SIGHTCELL_FRAME_OUTSIDE | SIGHTCELL_FRAME_DRAW_ALL), SIGHTCELL_FRAME_OUTSIDE);
    expect_shows(view, file, contents, frame, contents.sets[0], shown ? std::set{0u, 3u} : std::set{0u, 2u, 3u});
    sightcell_view_stats before{sizeof(sightcell_view_stats), 0, 0, 0, 0, 0, 0, 0, 0};
    ASSERT_EQ(sightcell_view_statistics(view.get(), &before), SIGHTCELL_OK);
    view.move(-6, -5, -5);
    sightcell_view_stats after = before;
    ASSERT_EQ(sightcell_view_statistics(view.get(), &after), SIGHTCELL_OK);
    EXPECT_EQ(after.rows_decoded, before.rows_decoded) << "once is enough";
  }
}

TEST(no_named_groups, are_there_in_most_files) {
  const loaded_file file(tiny_contents());
  test_view view(file.db());
  EXPECT_EQ(sightcell_db_named_group_count(file.db()), 0u);
  std::size_t count = 0;
  char letter = 0;
  EXPECT_EQ(sightcell_db_named_group_name(file.db(), 0, &letter, 1, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_show_named_group(view.get(), 0, 0), SIGHTCELL_ERR_ARGUMENT);
  numbers groups(tiny_contents().draws.size());
  EXPECT_EQ(sightcell_db_named_groups_of_draws(file.db(), groups.data(), groups.size(), &count), SIGHTCELL_OK);
  EXPECT_EQ(groups, numbers(groups.size(), SIGHTCELL_NO_NAMED_GROUP));
  std::uint32_t found = 5;
  EXPECT_EQ(sightcell_db_find_named_group(file.db(), "", &found), SIGHTCELL_OK);
  EXPECT_EQ(found, SIGHTCELL_NO_NAMED_GROUP);
  EXPECT_EQ(sightcell_db_find_named_group(file.db(), nullptr, &found), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_find_named_group(nullptr, "door", &found), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_named_group_count(nullptr), 0u);
  EXPECT_EQ(sightcell_view_show_named_group(nullptr, 0, 0), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_named_groups_of_draws(nullptr, groups.data(), 1, &count), SIGHTCELL_ERR_ARGUMENT);
}

}  // namespace
