// MSFT_lod and level_of: level 0 is seen and hides, the others follow it.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/object_levels.h"
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

json level_of(const json& name, const json& from_distance) {
  return {{"sightcell", {{"level_of", name}, {"from_distance", from_distance}}}};
}

// Node 1 is "wall", nodes 2 and 3 are both "twin".
gltf_sketch named_nodes() {
  gltf_sketch g = nodes(5);
  g.json["nodes"][1]["name"] = "wall";
  g.json["nodes"][2]["name"] = g.json["nodes"][3]["name"] = "twin";
  return g;
}

TEST(lod, levels_that_name_their_object_follow_by_distance) {
  gltf_sketch g = named_nodes();
  g.json["nodes"][0]["extras"] = level_of("wall", 30);
  g.json["nodes"][3]["extras"] = level_of("wall", 12.5);
  const scene s = load(g);
  EXPECT_EQ(places_of(s), (places{{0, 2}, {0, 0}, {-1, 0}, {0, 1}, {-1, 0}}));
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_EQ(flatten(s).absent.coarser_level, 2u);
  g.json["nodes"][1]["extensions"] = levels({4});
  EXPECT_EQ(places_of(load(g)), (places{{0, 3}, {0, 0}, {-1, 0}, {0, 2}, {0, 1}})) << "after those of MSFT_lod";
}

TEST(lod, levels_of_no_node_and_of_several_occlude_nothing) {
  for (const auto& [name, part] :
       {std::pair{"wal", "the name of no node, \"wal\""}, std::pair{"twin", "the name of several nodes, \"twin\""}}) {
    gltf_sketch g = named_nodes();
    g.json["nodes"][0]["extras"] = level_of(name, 5);
    g.json["nodes"][4]["extras"] = level_of(name, 6);
    const scene s = load(g);
    EXPECT_EQ(s.draws[0].lod_object, no_index);
    EXPECT_FALSE(s.draws[0].tags.occluder) << "a level that is drawn far away only";
    EXPECT_FALSE(s.draws[4].tags.occluder);
    EXPECT_TRUE(s.draws[1].tags.occluder);
    ASSERT_EQ(s.warnings.size(), 1u);
    EXPECT_NE(s.warnings[0].find(part), std::string::npos) << s.warnings[0];
    EXPECT_NE(s.warnings[0].find("nodes[0]"), std::string::npos) << s.warnings[0];
  }
}

TEST(lod, marks_of_levels_that_are_wrong_are_warnings) {
  const auto warned = [](const json& extras, int node = 0) {
    gltf_sketch g = named_nodes();
    g.json["nodes"][static_cast<std::size_t>(node)]["extras"] = extras;
    const scene s = load(g);
    return s.warnings.size() == 1 ? s.warnings[0] : std::to_string(s.warnings.size()) + " warnings";
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_PRED2(has, warned({{"sightcell", {{"level_of", 7}}}}), "\"level_of\" that is not the name of a node");
  EXPECT_PRED2(has, warned({{"sightcell", {{"from_distance", 7}}}}), "\"from_distance\" without a \"level_of\"");
  for (const json& distance : {json("far"), json(0), json(-3), json(2e7), json(nullptr), json::array({5})})
    EXPECT_PRED2(has, warned(level_of("wall", distance)), "not a number of meters above 0") << distance;
  EXPECT_PRED2(has, warned(level_of("wall", 5), 1), "nodes[1] has nodes[1] as a level of detail, which is itself");
  gltf_sketch g = named_nodes();
  g.json["nodes"][0]["name"] = "fence";
  g.json["nodes"][0]["extras"] = level_of("wall", 5);
  g.json["nodes"][1]["extras"] = level_of("fence", 5);
  const scene s = load(g);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_PRED2(has, s.warnings[0], "has it as a level in turn");
  EXPECT_EQ(std::count_if(s.draws.begin(), s.draws.end(), [](const draw& d) { return d.lod_level > 0; }), 1);
}

TEST(lod, a_distance_that_is_no_number_of_json_is_an_error) {
  gltf_sketch g = named_nodes();
  g.json["nodes"][0]["extras"] = level_of("wall", 12345);
  const temporary_folder folder;
  for (const char* number : {"NaN  ", "1e999"}) {
    std::string text = g.glb();
    text.replace(text.find("12345"), 5, number);
    try {
      (void)load_gltf(folder.write("number.glb", text));
      ADD_FAILURE() << number;
    } catch (const error& e) {
      EXPECT_EQ(e.id(), "scene.bad-json") << number;
    }
  }
}

struct scene_with_levels {
  scene s;
  object_levels levels;
};

scene_with_levels load_with_levels(const gltf_sketch& sketch) {
  const temporary_folder folder;
  const auto path = folder.write("lod.glb", sketch.glb());
  scene s = load_gltf(path);
  object_levels read = load_object_levels(path, s);
  return {std::move(s), std::move(read)};
}

// Node 0 is an object below node 5; of its levels node 2, with 3 below it, is outside the tree, and node 1 is in it.
gltf_sketch object_with_level_outside() {
  gltf_sketch g = nodes(6);
  g.json["scenes"] = {{{"nodes", {5, 1}}}};
  g.json["nodes"][5] = {{"children", {0}}, {"translation", {10, 0, 0}}};
  g.json["nodes"][0]["extensions"] = levels({2, 1});
  g.json["nodes"][0]["extras"]["MSFT_screencoverage"] = {0.5, 0.25, 0.01};
  g.json["nodes"][2]["translation"] = {0, 5, 0};
  g.json["nodes"][2]["children"] = {3};
  return g;
}

TEST(lod, levels_outside_the_tree_are_placed_as_their_object) {
  const scene_with_levels loaded = load_with_levels(object_with_level_outside());
  EXPECT_EQ(loaded.s.polygon_count, 2u);
  ASSERT_EQ(loaded.levels.objects.size(), 1u);
  const leveled_object& object = loaded.levels.objects[0];
  EXPECT_EQ(object.finest, std::vector<std::uint32_t>{0});
  EXPECT_EQ(object.least_coverage, 0.01f);
  ASSERT_EQ(object.coarser.size(), 2u);
  EXPECT_EQ(object.coarser[0].begins.below_coverage, 0.5f);
  EXPECT_EQ(object.coarser[0].polygons.first, 0u);
  EXPECT_EQ(object.coarser[0].polygons.count, 2u) << "with the node below it";
  EXPECT_EQ(object.coarser[1].begins.below_coverage, 0.25f);
  EXPECT_EQ(object.coarser[1].polygons.first, 2u);
  EXPECT_EQ(object.coarser[1].polygons.count, 1u);
  const std::vector<draw>& draws = loaded.levels.coarser.draws;
  ASSERT_EQ(draws.size(), 3u);
  EXPECT_EQ(glm::dvec3(draws[0].to_world[3]), glm::dvec3(10, 5, 0)) << "below the parent of the object";
  EXPECT_EQ(glm::dvec3(draws[1].to_world[3]), glm::dvec3(10, 5, 0));
  EXPECT_EQ(glm::dvec3(draws[2].to_world[3]), glm::dvec3(0, 0, 0));
  for (const draw& d : draws) EXPECT_EQ(d.lod_object, no_index);
  EXPECT_EQ(flatten(loaded.levels.coarser).absent.coarser_level, 0u);
}

TEST(lod, levels_in_the_tree_are_listed_once) {
  gltf_sketch g = named_nodes();
  g.json["nodes"][0]["extras"] = level_of("wall", 30);
  const scene_with_levels loaded = load_with_levels(g);
  ASSERT_EQ(loaded.levels.objects.size(), 1u);
  EXPECT_EQ(loaded.levels.objects[0].finest, std::vector<std::uint32_t>{1});
  ASSERT_EQ(loaded.levels.objects[0].coarser.size(), 1u);
  EXPECT_EQ(loaded.levels.objects[0].coarser[0].begins.from_distance, 30.0f);
  EXPECT_EQ(loaded.levels.coarser.polygon_count, 1u);
}

TEST(lod, coverages_that_are_missing_or_wrong_leave_levels_without_a_switch) {
  const auto expect_none = [](const json& coverages, std::size_t warnings) {
    gltf_sketch g = object_with_level_outside();
    if (coverages.is_null())
      g.json["nodes"][0].erase("extras");
    else
      g.json["nodes"][0]["extras"]["MSFT_screencoverage"] = coverages;
    const scene_with_levels loaded = load_with_levels(g);
    EXPECT_EQ(loaded.s.warnings.size(), 1 + warnings) << coverages << ": one is of the level outside the tree";
    ASSERT_EQ(loaded.levels.objects.size(), 1u);
    for (const object_level& level : loaded.levels.objects[0].coarser)
      EXPECT_FALSE(level.begins.below_coverage || level.begins.from_distance) << coverages;
    EXPECT_EQ(loaded.levels.objects[0].least_coverage, 0.0f);
  };
  expect_none(nullptr, 0);
  for (const json& wrong : {json::array({0.5}), json("half"), json(1), json::object(), json::array({0.5, -1, 0}),
                            json::array({0.5, "x", 0}), json::array({0.5, 1e300, 0})})
    expect_none(wrong, 1);
  gltf_sketch g = object_with_level_outside();
  g.json["nodes"][0]["extras"]["MSFT_screencoverage"] = {0.5, 0.25};
  const scene_with_levels loaded = load_with_levels(g);
  EXPECT_EQ(loaded.levels.objects[0].coarser[1].begins.below_coverage, 0.25f);
  EXPECT_EQ(loaded.levels.objects[0].least_coverage, 0.0f) << "the last level ends nowhere";
}

TEST(lod, a_level_outside_the_tree_belongs_to_one_object_and_is_no_cycle) {
  gltf_sketch g = object_with_level_outside();
  g.json["nodes"][1]["extensions"] = levels({2});
  g.json["nodes"][0]["extensions"] = levels({2});
  EXPECT_EQ(load_with_levels(g).levels.objects.size(), 1u);
  g = object_with_level_outside();
  g.json["nodes"][3]["children"] = {2};
  EXPECT_EQ(load(g).polygon_count, 2u);
  try {
    (void)load_with_levels(g);
    ADD_FAILURE() << "a cycle";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "scene.node-cycle");
  }
}

TEST(lod, without_levels_there_are_none) {
  const scene_with_levels loaded = load_with_levels(nodes(2));
  EXPECT_TRUE(loaded.levels.objects.empty());
  EXPECT_EQ(loaded.levels.coarser.polygon_count, 0u);
}

}  // namespace
}  // namespace sightcell::scene
