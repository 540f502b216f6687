// Marks of nodes and what moves: rule 6 of seeing, as glTF says it.
#include <gtest/gtest.h>

#include <algorithm>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

scene load(const gltf_sketch& sketch) {
  const temporary_folder folder;
  return load_gltf(folder.write("nodes.glb", sketch.glb()));
}

json marked(const json& marks) {
  return {{"sightcell", marks}};
}

// Nodes 0 -> 1 -> 2 and 3 beside them, a triangle each.
gltf_sketch chain() {
  gltf_sketch g;
  const int mesh = g.add_mesh(g.add_row_of_triangles(1));
  g.add_node({{"mesh", mesh}, {"children", {1}}});
  g.add_node({{"mesh", mesh}, {"children", {2}}});
  g.add_node({{"mesh", mesh}});
  g.add_node({{"mesh", mesh}});
  return g;
}

std::vector<bool> each(const scene& s, bool draw_tags::*tag) {
  std::vector<bool> out;
  for (const draw& d : s.draws) out.push_back(d.tags.*tag);
  return out;
}

using bools = std::vector<bool>;

TEST(marks, without_extras_nothing_is_tagged) {
  gltf_sketch g = chain();
  g.json["nodes"][0]["extras"] = 7;  // anything may be there
  g.json["nodes"][1]["extras"] = {{"bsp_model", 3}};
  const scene s = load(g);
  for (const draw& d : s.draws) EXPECT_EQ(d.tags, draw_tags{});
  EXPECT_TRUE(s.groups.empty());
  EXPECT_TRUE(s.warnings.empty());
}

TEST(marks, every_key_sets_its_tag_and_no_other) {
  const auto tags_with = [](const json& marks) {
    gltf_sketch g = chain();
    g.json["nodes"][3]["extras"] = marked(marks);
    const scene s = load(g);
    EXPECT_EQ(s.draws[0].tags, draw_tags{}) << marks;
    EXPECT_TRUE(s.warnings.empty()) << marks;
    return s.draws[3].tags;
  };
  EXPECT_EQ(tags_with({{"occluder", false}}), (draw_tags{.occluder = false}));
  EXPECT_EQ(tags_with({{"dynamic", true}}), (draw_tags{.dynamic = true}));
  EXPECT_EQ(tags_with({{"always", true}}), (draw_tags{.always = true}));
  EXPECT_EQ(tags_with({{"never", true}}), (draw_tags{.never = true}));
  EXPECT_EQ(tags_with({{"group", "door"}}), (draw_tags{.group = 0}));
  EXPECT_EQ(tags_with({{"static", true}, {"occluder", true}, {"dynamic", false}}), draw_tags{});
}

TEST(marks, children_inherit_and_override_key_by_key) {
  gltf_sketch g = chain();
  g.json["nodes"][0]["extras"] = marked({{"always", true}, {"occluder", false}, {"group", "gate"}});
  g.json["nodes"][1]["extras"] = marked({{"occluder", true}, {"group", ""}});
  g.json["nodes"][2]["extras"] = marked({{"always", false}, {"group", "wing"}});
  const scene s = load(g);
  EXPECT_EQ(each(s, &draw_tags::always), (bools{true, true, false, false}));
  EXPECT_EQ(each(s, &draw_tags::occluder), (bools{false, true, true, true}));
  EXPECT_EQ(s.groups, (std::vector<std::string>{"gate", "wing"}));
  EXPECT_EQ(s.draws[0].tags.group, 0u);
  EXPECT_EQ(s.draws[1].tags.group, no_index) << "an empty name leaves the group";
  EXPECT_EQ(s.draws[2].tags.group, 1u);
}

TEST(marks, what_is_not_shown_at_first_hides_nothing) {
  gltf_sketch g = chain();
  g.json["extensionsUsed"] = {"KHR_node_visibility"};
  g.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
  g.json["nodes"][2]["extensions"]["KHR_node_visibility"]["visible"] = true;  // its parent is not
  g.json["nodes"][2]["extras"] = marked({{"occluder", true}});
  const scene s = load(g);
  EXPECT_EQ(each(s, &draw_tags::occluder), (bools{true, false, false, true}));
  EXPECT_TRUE(s.warnings.empty());
}

TEST(marks, groups_are_those_that_have_draws) {
  gltf_sketch g = chain();
  g.add_node({{"extras", marked({{"group", "empty"}})}});
  g.json["nodes"][0]["extras"] = marked({{"group", "first"}});
  g.json["nodes"][3]["extras"] = marked({{"group", "first"}});
  const scene s = load(g);
  EXPECT_EQ(s.groups, std::vector<std::string>{"first"});
  EXPECT_EQ(s.draws[2].tags.group, 0u);
  EXPECT_EQ(s.draws[3].tags.group, 0u);
}

TEST(marks, what_is_wrong_is_one_warning_per_key_and_the_rest_applies) {
  gltf_sketch g = chain();
  const json wrong = {{"occluder", 0}, {"colour", "red"}, {"group", 3}, {"always", true}};
  g.json["nodes"][0]["extras"] = marked(wrong);
  g.json["nodes"][2]["extras"] = marked(wrong);
  g.json["nodes"][3]["extras"] = marked("static");
  const scene s = load(g);
  EXPECT_EQ(each(s, &draw_tags::always), (bools{true, true, true, false}));
  EXPECT_EQ(each(s, &draw_tags::occluder), (bools{true, true, true, true}));
  ASSERT_EQ(s.warnings.size(), 4u);
  const auto warned = [&s](const std::string& part) {
    return std::count_if(s.warnings.begin(), s.warnings.end(), [&part](const std::string& w) {
      return w.find(part) != std::string::npos && w.find('\n') == std::string::npos;
    });
  };
  EXPECT_EQ(warned("nodes[0] has a \"occluder\" that is not true or false"), 1);
  EXPECT_EQ(warned("nodes[0] has the unknown key \"colour\""), 1);
  EXPECT_EQ(warned("nodes[0] has a \"group\" that is not a name"), 1);
  EXPECT_EQ(warned("nodes[3] is not a JSON object"), 1);
}

// An animation with one channel; its sampler is not there: nothing of it is read.
void animate(gltf_sketch& g, const json& target) {
  g.json["animations"].push_back({{"channels", {{{"sampler", 9}, {"target", target}}}}, {"samplers", json::array()}});
}

json pointer(const std::string& where) {
  return {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", where}}}}}};
}

bools moved_by(const json& target) {
  gltf_sketch g = chain();
  animate(g, target);
  const scene s = load(g);
  const bools moved = each(s, &draw_tags::animated);
  const bool any = std::find(moved.begin(), moved.end(), true) != moved.end();
  EXPECT_EQ(s.warnings.size(), any ? 1u : 0u) << target;
  return moved;
}

TEST(movement, a_moved_node_takes_its_subtree_along) {
  for (const char* path : {"translation", "rotation", "scale"})
    EXPECT_EQ(moved_by({{"node", 1}, {"path", path}}), (bools{false, true, true, false})) << path;
  EXPECT_EQ(moved_by(pointer("/nodes/1/rotation")), (bools{false, true, true, false}));
  EXPECT_EQ(moved_by(pointer("/nodes/1/extensions/KHR_node_visibility/visible")), (bools{false, true, true, false}));
}

TEST(movement, animated_weights_move_the_mesh_of_their_node_alone) {
  EXPECT_EQ(moved_by({{"node", 1}, {"path", "weights"}}), (bools{false, true, false, false}));
  EXPECT_EQ(moved_by(pointer("/nodes/3/weights/0")), (bools{false, false, false, true}));
  EXPECT_EQ(moved_by(pointer("/meshes/0/weights/0")), (bools{true, true, true, true}));
  EXPECT_EQ(moved_by(pointer("/meshes/1/weights/0")), (bools{false, false, false, false}));
}

TEST(movement, channels_that_aim_at_nothing_move_nothing) {
  const bools none = {false, false, false, false};
  EXPECT_EQ(moved_by(json::object()), none);
  EXPECT_EQ(moved_by({{"path", "translation"}}), none);
  EXPECT_EQ(moved_by({{"node", 1}, {"path", "sparkle"}}), none);
  EXPECT_EQ(moved_by({{"node", 1}}), none);
  for (const char* where : {"", "/", "/nodes", "/nodes/", "/nodes/99/scale", "/nodes/-1/scale", "/cameras/0/yfov"})
    EXPECT_EQ(moved_by(pointer(where)), none) << where;
  gltf_sketch g = chain();
  g.json["animations"] = {{{"channels", json::array()}}, json::object()};
  EXPECT_TRUE(load(g).warnings.empty());
}

TEST(movement, animated_materials_are_said_to_rest) {
  gltf_sketch g = chain();
  animate(g, pointer("/materials/0/alphaCutoff"));
  animate(g, pointer("/materials/1/alphaCutoff"));
  const scene s = load(g);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("materials"), std::string::npos);
}

TEST(movement, marks_in_force_take_it_away) {
  const auto tags_with = [](const json& marks) {
    gltf_sketch g = chain();
    g.json["nodes"][0]["extras"] = marked(marks);
    animate(g, {{"node", 1}, {"path", "translation"}});
    return load(g).draws[2].tags;
  };
  EXPECT_EQ(tags_with(json::object()), (draw_tags{.animated = true}));
  EXPECT_EQ(tags_with({{"static", true}}), draw_tags{});
  EXPECT_EQ(tags_with({{"dynamic", true}}), (draw_tags{.dynamic = true}));
  EXPECT_EQ(tags_with({{"occluder", false}}), (draw_tags{.occluder = false}));
  EXPECT_EQ(tags_with({{"group", "fan"}}), (draw_tags{.group = 0}));
  EXPECT_EQ(tags_with({{"never", true}}), (draw_tags{.never = true}));
  // In every set is not yet "hides what lies behind its rest".
  EXPECT_EQ(tags_with({{"always", true}}), (draw_tags{.occluder = false, .always = true}));
  EXPECT_EQ(tags_with({{"always", true}, {"static", true}}), (draw_tags{.always = true}));
  EXPECT_EQ(tags_with({{"always", true}, {"occluder", true}}), (draw_tags{.always = true}));
  // What is as it would be without a mark is none.
  EXPECT_EQ(tags_with({{"static", false}, {"occluder", true}, {"group", ""}}), (draw_tags{.animated = true}));
}

// Marks say what is seen; that the host moves it all the same matters to who merges draws.
TEST(movement, of_marked_draws_is_known) {
  const auto moves_with = [](const json& marks) {
    gltf_sketch g = chain();
    g.json["nodes"][0]["extras"] = marked(marks);
    animate(g, {{"node", 1}, {"path", "translation"}});
    std::vector<bool> moves;
    for (const draw& d : load(g).draws) moves.push_back(d.moves);
    return moves;
  };
  for (const json& marks : {json::object(), json{{"group", "fan"}}, json{{"always", true}}})
    EXPECT_EQ(moves_with(marks), (std::vector<bool>{false, true, true, false})) << marks;
  EXPECT_EQ(moves_with({{"static", true}}), std::vector<bool>(4, false));
  EXPECT_EQ(moves_with({{"dynamic", true}})[2], true);
}

TEST(movement, is_one_warning_with_numbers) {
  gltf_sketch g = chain();
  g.json["nodes"][2]["mesh"] = g.add_mesh(g.add_row_of_triangles(5));
  animate(g, {{"node", 1}, {"path", "translation"}});
  animate(g, {{"node", 2}, {"path", "rotation"}});
  const scene s = load(g);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_EQ(s.warnings[0].find("animations and skins move 2 draws of 6 polygons"), 0u) << s.warnings[0];
}

TEST(movement, what_a_channel_aims_at_must_be_there) {
  const auto id_with = [](const json& animations) -> std::string {
    gltf_sketch g = chain();
    g.json["animations"] = animations;
    try {
      (void)load(g);
    } catch (const error& e) {
      return e.id();
    }
    return "none";
  };
  const auto channel = [](const json& target) { return json{{{"channels", {{{"target", target}}}}}}; };
  EXPECT_EQ(id_with(channel({{"node", 4}, {"path", "translation"}})), "scene.index-out-of-range");
  EXPECT_EQ(id_with(channel({{"node", "one"}, {"path", "translation"}})), "scene.bad-field");
  EXPECT_EQ(id_with(channel({{"node", 1}, {"path", 5}})), "scene.bad-field");
  EXPECT_EQ(id_with(channel(7)), "scene.bad-field");
  EXPECT_EQ(id_with(7), "scene.bad-field");
  EXPECT_EQ(id_with({{{"channels", {{{"target", {{"node", 1}, {"path", "scale"}}}}}}, {"samplers", 5}}}), "none");
}

TEST(gltf_nodes, starts_are_marked_nodes_and_cameras) {
  gltf_sketch g = chain();
  g.json["cameras"] = json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}});
  const int camera = g.add_node({{"camera", 0}, {"translation", {1, 2, 3}}});
  g.add_node({{"translation", {10, 0, 0}}, {"children", {camera}}});
  g.add_node({{"camera", 0}, {"translation", {4, 5, 6}}, {"extras", marked({{"start", true}})}});
  const scene s = load(g);
  ASSERT_EQ(s.starts.size(), 2u);
  std::vector<std::array<float, 3>> cameras, starts;
  for (const start_point& start : s.starts) (start.is_camera ? cameras : starts).push_back(start.position);
  EXPECT_EQ(cameras, (std::vector<std::array<float, 3>>{{11, 2, 3}}));
  EXPECT_EQ(starts, (std::vector<std::array<float, 3>>{{4, 5, 6}})) << "a marked camera is a start as others are";
}

}  // namespace
}  // namespace sightcell::scene
