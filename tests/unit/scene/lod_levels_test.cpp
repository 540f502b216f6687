// MSFT_lod: level 0 is seen and hides, the others follow it.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

json levels(const json& ids) {
  return {{"MSFT_lod", {{"ids", ids}}}};
}

// So many nodes with a triangle each, all roots.
gltf_sketch nodes(int count) {
  gltf_sketch g;
  const int mesh = g.add_mesh(g.add_row_of_triangles(1));
  for (int i = 0; i < count; ++i) g.add_node({{"mesh", mesh}});
  return g;
}

scene load(const gltf_sketch& sketch) {
  const temporary_folder folder;
  return load_gltf(folder.write("lod.glb", sketch.glb()));
}

// (object, level) by node; object -1: none.
using places = std::vector<std::pair<int, std::uint32_t>>;
places places_of(const scene& s) {
  places out(s.node_names.size(), {-2, 0});
  for (const draw& d : s.draws) out[d.node] = {static_cast<int>(d.lod_object), d.lod_level};
  return out;
}

TEST(lod, levels_in_the_tree_have_their_object_and_number) {
  gltf_sketch g = nodes(7);
  g.json["extensionsRequired"] = {"MSFT_lod"};
  g.json["nodes"][1]["extensions"] = levels({4, 2});
  g.json["nodes"][1]["children"] = {3};
  g.json["nodes"][2]["children"] = {5};
  const scene s = load(g);
  EXPECT_EQ(places_of(s), (places{{-1, 0}, {0, 0}, {0, 2}, {0, 0}, {0, 1}, {0, 2}, {-1, 0}}));
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_EQ(s.polygon_count, 7u) << "they have source ids";
  const world_geometry w = flatten(s);
  ASSERT_EQ(w.lods.size(), 1u);
  EXPECT_EQ(w.absent.coarser_level, 3u);
}

TEST(lod, objects_are_numbered_by_their_first_draws) {
  gltf_sketch g = nodes(4);
  g.json["nodes"][2]["extensions"] = levels({0});
  g.json["nodes"][1]["extensions"] = levels({3});
  EXPECT_EQ(places_of(load(g)), (places{{0, 1}, {1, 0}, {0, 0}, {1, 1}}));
}

TEST(lod, levels_outside_the_scene_are_left_out_with_one_warning) {
  gltf_sketch g = nodes(5);
  g.json["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {3}}}};
  g.json["nodes"][0]["extensions"] = levels({2, 3});
  g.json["nodes"][1]["extensions"] = levels({4});
  const scene s = load(g);
  EXPECT_EQ(s.polygon_count, 2u);
  EXPECT_EQ(s.draws[0].lod_object, no_index) << "nothing follows it";
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_EQ(s.warnings[0].find("3 levels of detail are not in the scene"), 0u) << s.warnings[0];
  // Of an object that is not in the scene itself nothing is said.
  g.json["scene"] = 1;
  const scene other = load(g);
  EXPECT_EQ(other.polygon_count, 1u);
  EXPECT_EQ(other.draws[0].lod_object, no_index);
  EXPECT_TRUE(other.warnings.empty());
}

TEST(lod, levels_may_hang_below_their_object) {
  gltf_sketch g = nodes(4);
  g.json["nodes"][0] = {{"children", {1, 2, 3}}, {"extensions", levels({2, 3})}};
  const scene s = load(g);
  EXPECT_EQ(places_of(s), (places{{-2, 0}, {0, 0}, {0, 1}, {0, 2}}));
}

TEST(lod, objects_inside_one_another_are_one) {
  gltf_sketch g = nodes(5);
  g.json["nodes"][0]["children"] = {1};  // 0 at levels 0, 2; inside it 1 at levels 1, 3
  g.json["nodes"][0]["extensions"] = levels({2});
  g.json["nodes"][1]["extensions"] = levels({3});
  EXPECT_EQ(places_of(load(g)), (places{{0, 0}, {0, 0}, {0, 1}, {0, 1}, {-1, 0}}));
  g.json["nodes"][2]["extensions"] = levels({4});  // a level with levels
  EXPECT_EQ(places_of(load(g)), (places{{0, 0}, {0, 0}, {0, 1}, {0, 1}, {0, 1}}));
}

TEST(lod, an_object_inside_a_coarser_level_is_no_finer_than_that) {
  gltf_sketch g = nodes(5);
  g.json["nodes"][0]["extensions"] = levels({2});
  g.json["nodes"][2]["children"] = {3};
  g.json["nodes"][3]["extensions"] = levels({4});
  EXPECT_EQ(places_of(load(g)), (places{{0, 0}, {-1, 0}, {0, 1}, {0, 1}, {0, 1}}));
}

TEST(lod, a_finest_level_without_triangles_gives_its_place_to_the_next) {
  gltf_sketch g = nodes(3);
  g.json["nodes"][0].erase("mesh");
  g.json["nodes"][0]["extensions"] = levels({1, 2});
  EXPECT_EQ(places_of(load(g)), (places{{-2, 0}, {0, 0}, {0, 1}}));
  g.json["nodes"][0]["extensions"] = levels({1});
  EXPECT_EQ(places_of(load(g)), (places{{-2, 0}, {-1, 0}, {-1, 0}}));
}

TEST(lod, what_contradicts_itself_is_a_warning) {
  const auto after = [](const std::vector<std::pair<int, json>>& objects, const char* part) {
    gltf_sketch g = nodes(4);
    g.json["nodes"][2]["children"] = {3};
    for (const auto& [node, ids] : objects) g.json["nodes"][static_cast<std::size_t>(node)]["extensions"] = levels(ids);
    const scene s = load(g);
    EXPECT_EQ(s.warnings.size(), 1u) << part;
    EXPECT_NE(s.warnings.at(0).find(part), std::string::npos) << s.warnings.at(0);
    // Whatever a file says, every object has a level that can be seen.
    const world_geometry w = flatten(s);
    EXPECT_LT(std::count_if(w.kinds.begin(), w.kinds.end(), [](polygon_kind k) { return k.absent; }), 4) << part;
    return places_of(s);
  };
  EXPECT_EQ(after({{0, {0, 1}}}, "nodes[0] has nodes[0] as a level of detail, which is itself"),
            (places{{0, 0}, {0, 2}, {-1, 0}, {-1, 0}}));
  EXPECT_EQ(after({{3, {2, 1}}}, "which is an ancestor of it"), (places{{-1, 0}, {0, 2}, {-1, 0}, {0, 0}}));
  EXPECT_EQ(after({{0, {1}}, {2, {1}}}, "is a level of nodes[0] already"), (places{{0, 0}, {0, 1}, {-1, 0}, {-1, 0}}));
  EXPECT_EQ(after({{0, {1, 1}}}, "is a level of nodes[0] already"), (places{{0, 0}, {0, 1}, {-1, 0}, {-1, 0}}));
  EXPECT_EQ(after({{0, {1}}, {1, {0}}}, "has it as a level in turn"), (places{{0, 0}, {0, 1}, {-1, 0}, {-1, 0}}));
  EXPECT_EQ(after({{0, {1}}, {1, {2}}, {2, {0}}}, "has it as a level in turn"),
            (places{{0, 0}, {0, 1}, {0, 1}, {0, 1}}));
}

TEST(lod, ids_must_be_nodes_and_those_of_materials_do_not_matter) {
  gltf_sketch g = nodes(1);
  g.json["materials"] = {{{"extensions", {{"MSFT_lod", {{"ids", {7}}}}}}}};
  g.json["extensionsUsed"] = {"MSFT_lod"};
  EXPECT_TRUE(load(g).warnings.empty());
  const auto id_with = [&g](const json& ids) -> std::string {
    g.json["nodes"][0]["extensions"] = levels(ids);
    try {
      (void)load(g);
    } catch (const error& e) {
      return e.id();
    }
    return "none";
  };
  EXPECT_EQ(id_with(json::array()), "none");
  EXPECT_EQ(id_with({1}), "scene.index-out-of-range");
  EXPECT_EQ(id_with({-1}), "scene.bad-field");
  EXPECT_EQ(id_with("all"), "scene.bad-field");
}

}  // namespace
}  // namespace sightcell::scene
