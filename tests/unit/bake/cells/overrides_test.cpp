// What a cells file says of polygons by hand.
#include "cells/overrides.h"

#include <gtest/gtest.h>

#include "errors/error_id.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using ids = std::vector<std::uint32_t>;
using pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // first, last

pairs pairs_of(const overrides::ranges& all) {
  pairs out;
  for (const scene::polygon_range& r : all) out.emplace_back(r.first, r.first + r.count - 1);
  return out;
}

// Five draws of two polygons each; nodes 1 and 3 have the same name, node 4 none.
scene::scene five_walls() {
  test::tiny_scene s;
  for (int i = 0; i < 5; ++i) s.wall_x(static_cast<float>(i), 1, static_cast<float>(1 + i));
  scene::scene made = s.finished();
  made.node_names = {"floor", "door", "wall", "door", "", "camera"};
  return made;
}

overrides parsed(const std::string& text) {
  return parse_overrides(text, "cells.json", five_walls());
}

std::string id_of(const std::string& text) {
  return test::error_id([&] { (void)parsed(text); });
}

TEST(overrides, polygons_and_ranges_are_put_together) {
  const overrides given = parsed(R"({"always":{"polygons":[3,[5,6],4,[5,7],1,1]},"never":{"polygons":[[9,9]]}})");
  EXPECT_EQ(pairs_of(given.always), (pairs{{1, 1}, {3, 7}}));
  EXPECT_EQ(pairs_of(given.never), (pairs{{9, 9}}));
  EXPECT_TRUE(given.add.empty());
  EXPECT_EQ(pairs_of(parsed(R"({"always":{"polygons":[[3,8],[4,5]]}})").always), (pairs{{3, 8}}));
}

TEST(overrides, a_name_is_all_draws_of_all_nodes_with_it) {
  EXPECT_EQ(pairs_of(parsed(R"({"always":{"nodes":["door"],"polygons":[0]}})").always),
            (pairs{{0, 0}, {2, 3}, {6, 7}}));
  EXPECT_EQ(pairs_of(parsed(R"({"never":{"nodes":["wall","door"]}})").never), (pairs{{2, 7}}));
}

TEST(overrides, cells_add_by_their_number_in_the_file) {
  const overrides given = parsed(R"({"cells":[{},{"add":{"polygons":[2]}},{},{"add":{"nodes":["floor"]}},{}]})");
  ASSERT_EQ(given.add.size(), 4u);
  EXPECT_EQ(pairs_of(given.add[1]), (pairs{{2, 2}}));
  ids set{4, 7};
  add_polygons(given, 0, set);
  add_polygons(given, 4, set);
  EXPECT_EQ(set, (ids{4, 7}));
  add_polygons(given, 1, set);
  add_polygons(given, 3, set);
  EXPECT_EQ(set, (ids{0, 1, 2, 4, 7}));
}

TEST(overrides, what_is_wrong_is_refused) {
  EXPECT_EQ(id_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,1]}]})"), "");
  for (const char* text :
       {R"({"always":7})", R"({"never":[]})", R"({"always":{"node":["door"]}})", R"({"always":{"nodes":"door"}})",
        R"({"always":{"nodes":[7]}})", R"({"always":{"polygons":7}})", R"({"always":{"polygons":[-1]}})",
        R"({"always":{"polygons":[1.5]}})", R"({"always":{"polygons":["1"]}})", R"({"always":{"polygons":[[1,2,3]]}})",
        R"({"always":{"polygons":[[4,3]]}})", R"({"cells":[{"add":3}]})"})
    EXPECT_EQ(id_of(text), "cells.bad-override") << text;
  for (const char* text : {R"({"always":{"nodes":["moon"]}})", R"({"never":{"nodes":["camera"]}})"})
    EXPECT_EQ(id_of(text), "cells.no-such-node") << text;
  for (const char* text : {R"({"always":{"polygons":[10]}})", R"({"never":{"polygons":[[0,10]]}})",
                           R"({"cells":[{"add":{"polygons":[4294967296]}}]})"})
    EXPECT_EQ(id_of(text), "cells.no-such-polygon") << text;
  EXPECT_EQ(id_of("{"), "cells.not-json");
}

TEST(overrides, kinds_are_changed_after_flattening) {
  const scene::scene s = five_walls();
  scene::world_geometry geometry = scene::flatten(s);
  geometry.kinds[4].absent = geometry.kinds[5].absent = true;
  const float before = geometry.max.y;
  apply(parsed(R"({"always":{"polygons":[0,2,4]},"never":{"polygons":[2,5,[8,9]]}})"), geometry);
  EXPECT_TRUE(geometry.kinds[0].always);
  EXPECT_TRUE(geometry.kinds[2].absent) << "never wins";
  EXPECT_FALSE(geometry.kinds[2].always);
  EXPECT_FALSE(geometry.kinds[4].always) << "what is absent stays out";
  EXPECT_TRUE(geometry.kinds[9].absent);
  EXPECT_FALSE(geometry.kinds[1].always || geometry.kinds[1].absent);
  EXPECT_EQ(geometry.absent.tagged, 3u);
  EXPECT_LT(geometry.max.y, before) << "bounds are those of what is left";
  EXPECT_EQ(geometry.max.y, 4.0f);
}

TEST(overrides, masks_and_levels_of_never_are_gone) {
  test::tiny_scene tiny;
  tiny.wall_x(1, 1, 1);
  tiny.masked_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, {0, 255}});
  scene::world_geometry geometry = scene::flatten(tiny.finished());
  ASSERT_EQ(geometry.masked.size(), 2u);
  geometry.lods = {{{{0, 1}}, {{1, 3}}}};
  overrides given;
  given.never = {{2, 1}};
  apply(given, geometry);
  ASSERT_EQ(geometry.masked.size(), 1u);
  EXPECT_EQ(geometry.masked[0].id, 3u);
  EXPECT_FALSE(geometry.kinds[2].alpha_tested);
  EXPECT_EQ(pairs_of(geometry.lods[0].coarser), (pairs{{1, 1}, {3, 3}}));
}

TEST(overrides, masks_after_those_of_never_keep_their_opacity_maps) {
  test::tiny_scene tiny;
  tiny.masked_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {8, 1, {0, 0, 0, 0, 255, 255, 255, 255}});
  tiny.masked_quad({0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {8, 1, {255, 255, 255, 255, 0, 0, 0, 0}});
  scene::world_geometry geometry = scene::flatten(tiny.finished());
  const auto known = [&](std::size_t masked) {
    std::vector<scene::opacity> out;
    for (const float u : {0.1f, 0.5f, 0.8f}) out.push_back(geometry.opacity.at(masked, u, 0.1f));
    return out;
  };
  const std::vector<scene::opacity> before = known(2);
  ASSERT_NE(before, known(0));
  overrides given;
  given.never = {{0, 2}};
  apply(given, geometry);
  EXPECT_EQ(geometry.opacity.map_of.size(), geometry.masked.size());
  EXPECT_EQ(known(0), before);
}

TEST(overrides, never_wins_over_what_a_cell_adds) {
  ids set{5};
  add_polygons(parsed(R"({"never":{"polygons":[2,4]},"cells":[{"add":{"polygons":[[1,5],8]}}]})"), 0, set);
  EXPECT_EQ(set, (ids{1, 3, 5, 8}));
}

TEST(overrides, every_difference_is_in_the_hash) {
  EXPECT_EQ(hash_of({}), 0u);
  std::vector<std::uint64_t> hashes;
  for (const char* text : {R"({"always":{"polygons":[1]}})", R"({"always":{"polygons":[2]}})",
                           R"({"never":{"polygons":[1]}})", R"({"always":{"polygons":[[1,2]]}})",
                           R"({"cells":[{"add":{"polygons":[1]}}]})", R"({"cells":[{},{"add":{"polygons":[1]}}]})"})
    hashes.push_back(hash_of(parsed(text)));
  std::sort(hashes.begin(), hashes.end());
  EXPECT_EQ(std::adjacent_find(hashes.begin(), hashes.end()), hashes.end());
  EXPECT_EQ(hash_of(parsed(R"({"always":{"polygons":[[6,7],2,3]}})")),
            hash_of(parsed(R"({"always":{"nodes":["door"]}})")));
}

TEST(overrides, a_file_tells_its_always_and_never) {
  const overrides given = parsed(R"({"always":{"polygons":[1]},"never":{"polygons":[[3,5],7]}})");
  const std::string text = with_overrides(R"({"samples":8})", given);
  EXPECT_EQ(text, R"({"samples":8,"overrides":{"always":[[1,1]],"never":[[3,5],[7,7]]}})");
  const overrides stored = stored_overrides(text, 10);
  EXPECT_EQ(pairs_of(stored.always), pairs_of(given.always));
  EXPECT_EQ(pairs_of(stored.never), pairs_of(given.never));
  EXPECT_EQ(with_overrides("{}", {}), "{}");
  EXPECT_TRUE(stored_overrides("{}", 10).empty());
}

TEST(overrides, nonsense_in_a_file_is_passed_over) {
  for (const char* text : {"", "7", "{", R"({"overrides":7})", R"({"overrides":{"never":7}})",
                           R"({"overrides":{"never":[7,[1],[1,2,3],["a","b"],[-1,2],[5,4],[9,10]]}})"})
    EXPECT_TRUE(stored_overrides(text, 10).empty()) << text;
  EXPECT_EQ(pairs_of(stored_overrides(R"({"overrides":{"never":[[5,4],[2,3]]}})", 10).never), (pairs{{2, 3}}));
}

}  // namespace
}  // namespace sightcell::bake
