#include "order/kept_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <string>

namespace sightcell::bake {
namespace {

using numbers = std::vector<std::uint32_t>;

constexpr std::uint32_t gone = UINT32_MAX;

// A draw of a version of a scene. what: the hash of its geometry.
struct piece {
  std::uint32_t mesh = 0, count = 0;
  std::uint64_t what = 0;
  std::string node;
};

struct version {
  std::vector<format::draw_record> draws;
  draw_identity identity;
};

version version_of(const std::vector<piece>& pieces) {
  version made;
  std::uint32_t next = 0;
  for (const piece& p : pieces) {
    format::draw_record d{.node = static_cast<std::uint32_t>(made.draws.size()), .mesh = p.mesh};
    d.group = d.node / 2;
    d.first_source = next;
    d.polygon_count = p.count;
    made.draws.push_back(d);
    if (p.count > 0) made.identity.hashes.push_back(p.what);
    made.identity.node_names.push_back(p.node);
    next += p.count;
  }
  return made;
}

// Two instances of one mesh, a draw without polygons, and two other meshes.
std::vector<piece> some_pieces() {
  return {{0, 8, 100, "a"}, {1, 12, 101, "b"}, {0, 8, 100, "c"}, {2, 0, 0, "d"}, {3, 6, 103, "e"}};
}

numbers identity_map(std::uint32_t count) {
  numbers map(count);
  std::iota(map.begin(), map.end(), 0u);
  return map;
}

numbers shuffled(std::uint32_t count, std::mt19937& random) {
  numbers order = identity_map(count);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

// An earlier file with draws from the last to the first, and polygons in random orders.
earlier_order stored_at_random(const version& v, bool merged) {
  std::mt19937 random(7);
  earlier_order before;
  format::file_parts& file = before.file;
  file.draws = v.draws;
  std::stable_sort(file.draws.begin(), file.draws.end(), [&](const auto& a, const auto& b) {
    return merged ? a.group > b.group : a.first_source > b.first_source;
  });
  std::stable_sort(file.draws.begin(), file.draws.end(), [&](const auto& a, const auto& b) {
    return !merged && (a.polygon_count > 0) > (b.polygon_count > 0);
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> units;  // mesh or group of each order
  for (std::size_t i = 0; i < file.draws.size(); ++i) {
    format::draw_record& d = file.draws[i];
    const std::uint32_t unit = merged ? d.group : d.mesh;
    auto found = std::find_if(units.begin(), units.end(), [&](const auto& u) { return u.first == unit; });
    if (found == units.end()) {
      units.emplace_back(unit, static_cast<std::uint32_t>(file.orders.size()));
      found = units.end() - 1;
      std::uint32_t count = 0;
      for (const format::draw_record& other : file.draws)
        count += merged ? (other.group == unit ? other.polygon_count : 0) : (&other == &d ? d.polygon_count : 0);
      file.orders.push_back(shuffled(count, random));
    }
    file.order_of_draw.push_back(found->second);
  }
  if (merged)
    for (std::size_t i = 0; i < file.draws.size(); ++i) file.draws[i].group = file.order_of_draw[i];
  lay_end_to_end(file.draws);
  file.geometry_hashes = v.identity.hashes;
  file.node_names = v.identity.node_names;
  std::uint32_t polygons = 0;
  for (const format::draw_record& d : v.draws) polygons += d.polygon_count;
  before.new_of = identity_map(polygons);
  return before;
}

stored_draws kept(const version& now, const earlier_order& before, bool merged = false) {
  return keep_order(now.draws, merged ? format::host_layout::merged : format::host_layout::instanced,
                    polygon_order_kind::per_mesh, now.identity, before);
}

numbers nodes_of(const std::vector<format::draw_record>& draws) {
  numbers nodes;
  for (const format::draw_record& d : draws) nodes.push_back(d.node);
  return nodes;
}

TEST(kept_order, nothing_edited) {
  for (const bool merged : {false, true}) {
    const version v = version_of(some_pieces());
    const earlier_order before = stored_at_random(v, merged);
    const stored_draws same = kept(v, before, merged);
    EXPECT_EQ(nodes_of(same.draws), nodes_of(before.file.draws)) << merged;
    EXPECT_EQ(same.orders, before.file.orders);
    EXPECT_EQ(same.order_of_draw, before.file.order_of_draw);
    for (std::size_t i = 0; i < same.draws.size(); ++i)
      EXPECT_EQ(same.draws[i].first_stored, before.file.draws[i].first_stored);
  }
}

// All of its polygons are new, but its geometry is not, and it has its name.
TEST(kept_order, a_draw_that_moved_stays_where_it_was) {
  const version v = version_of(some_pieces());
  earlier_order before = stored_at_random(v, false);
  for (std::uint32_t i = 8; i < 20; ++i) before.new_of[i] = gone;
  const stored_draws moved = kept(v, before);
  EXPECT_EQ(nodes_of(moved.draws), nodes_of(before.file.draws));
  EXPECT_EQ(moved.orders, before.file.orders);
}

TEST(kept_order, an_instance_that_is_new_has_the_order_of_the_others) {
  std::vector<piece> pieces = some_pieces();
  const earlier_order before = stored_at_random(version_of(pieces), false);
  pieces.push_back({0, 8, 100, "f"});
  const stored_draws more = kept(version_of(pieces), before);
  ASSERT_EQ(more.draws.size(), 6u);
  EXPECT_EQ(nodes_of(more.draws), (numbers{4, 2, 1, 0, 5, 3})) << "before those without polygons";
  EXPECT_EQ(more.order_of_draw[4], more.order_of_draw[3]);
  EXPECT_EQ(more.orders, before.file.orders);
}

TEST(kept_order, what_is_left_after_a_draw_is_gone) {
  std::vector<piece> pieces = some_pieces();
  earlier_order before = stored_at_random(version_of(pieces), false);
  pieces.erase(pieces.begin());
  std::fill_n(before.new_of.begin(), 8, gone);
  for (std::size_t i = 8; i < before.new_of.size(); ++i) before.new_of[i] -= 8;
  const stored_draws rest = kept(version_of(pieces), before);
  EXPECT_EQ(nodes_of(rest.draws), (numbers{3, 1, 0, 2})) << "as before, with numbers that are smaller by one";
  EXPECT_EQ(rest.orders, before.file.orders) << "the other instance has that of the mesh";
}

// A mesh is split in two: each part has the polygons in the order in which the whole had them.
TEST(kept_order, parts_of_a_mesh) {
  std::vector<piece> pieces = some_pieces();
  const earlier_order before = stored_at_random(version_of(pieces), false);
  pieces[1] = {4, 5, 104, "b"};
  pieces.insert(pieces.begin() + 2, {5, 7, 105, "b2"});
  const stored_draws split = kept(version_of(pieces), before);
  const numbers& whole = before.file.orders[2];
  numbers first, second;
  for (const std::uint32_t p : whole) (p < 5 ? first : second).push_back(p < 5 ? p : p - 5);
  const auto order_of = [&](std::uint32_t node) {
    for (std::size_t i = 0; i < split.draws.size(); ++i)
      if (split.draws[i].node == node) return split.orders[split.order_of_draw[i]];
    return numbers();
  };
  EXPECT_EQ(order_of(1), first);
  EXPECT_EQ(order_of(2), second);
}

// Polygons without an earlier one follow the one before them in source order.
TEST(kept_order, polygons_that_are_new) {
  for (const bool merged : {false, true}) {
    earlier_order before = stored_at_random(version_of({{0, 6, 0, ""}, {1, 2, 0, ""}}), merged);
    before.file.orders =
        merged ? std::vector<numbers>{{7, 5, 3, 1, 0, 2, 4, 6}} : std::vector<numbers>{{1, 0}, {5, 4, 3, 2, 1, 0}};
    before.new_of = {0, 2, 3, 5, 6, gone, 7, 8};
    const stored_draws mixed = kept(version_of({{0, 7, 0, ""}, {1, 2, 0, ""}}), before, merged);
    const numbers expected = merged ? numbers{8, 5, 2, 0, 1, 3, 4, 6, 7} : numbers{6, 5, 3, 4, 2, 0, 1};
    EXPECT_EQ(mixed.orders[merged ? 0 : 1], expected);
  }
}

// Corners of some polygons of a mesh were moved.
TEST(kept_order, polygons_that_changed_in_place) {
  std::vector<piece> pieces = some_pieces();
  earlier_order before = stored_at_random(version_of(pieces), false);
  for (const std::uint32_t i : {8u, 11u, 19u}) before.new_of[i] = gone;
  pieces[1].what = 999;
  const stored_draws changed = kept(version_of(pieces), before);
  EXPECT_EQ(nodes_of(changed.draws), nodes_of(before.file.draws));
  EXPECT_EQ(changed.orders, before.file.orders);
}

TEST(kept_order, a_scene_of_other_polygons_is_in_source_order) {
  const version v = version_of({{0, 3, 1, "x"}, {1, 4, 2, "y"}, {0, 3, 1, "z"}});
  earlier_order before = stored_at_random(version_of(some_pieces()), false);
  std::fill(before.new_of.begin(), before.new_of.end(), gone);
  const stored_draws other = kept(v, before);
  EXPECT_EQ(nodes_of(other.draws), (numbers{0, 1, 2}));
  EXPECT_EQ(other.orders, (std::vector<numbers>{{0, 1, 2}, {0, 1, 2, 3}}));
}

}  // namespace
}  // namespace sightcell::bake
