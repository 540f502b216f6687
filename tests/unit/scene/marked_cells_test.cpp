// View cells in a scene: boxes of nodes with extras.sightcell.cell.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "loaded_sketch.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using corner = std::array<float, 3>;

const nlohmann::json mark = {{"sightcell", {{"cell", true}}}};

// A mesh of one triangle that is seen, in a node of its own: source id 0.
gltf_sketch with_a_triangle() {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  return g;
}

// A tetrahedron in the box from 0 to (2, 3, 4).
int add_solid(gltf_sketch& g) {
  return g.add_mesh(g.add_positions({0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 3, 0, 0, 0, 4}));
}

TEST(marked_cells, an_empty_is_the_cube_that_blender_shows) {
  gltf_sketch g = with_a_triangle();
  const int child =
      g.add_node({{"name", "balcony"}, {"extras", mark}, {"translation", {0, 5, 0}}, {"scale", {2, 0.5, 1}}});
  g.add_node({{"translation", {10, 0, 0}}, {"children", {child}}});
  const scene s = load(g);
  ASSERT_EQ(s.cells.size(), 1u);
  EXPECT_EQ(s.cells[0].name, "balcony");
  EXPECT_EQ(s.cells[0].min, (corner{8.0f, 4.5f, -1.0f}));
  EXPECT_EQ(s.cells[0].max, (corner{12.0f, 5.5f, 1.0f}));
  EXPECT_EQ(flatten(s).cells.size(), 1u);
}

TEST(marked_cells, a_mesh_gives_its_box_and_is_in_no_set) {
  gltf_sketch g = with_a_triangle();
  const std::array<std::uint8_t, 16> before = load(g).fingerprint;
  const int solid = add_solid(g);
  // A quarter turn about Y: x becomes -z.
  g.add_node({{"mesh", solid},
              {"extras", mark},
              {"translation", {1, 1, 1}},
              {"rotation", {0, 0.70710678118, 0, 0.70710678118}}});
  g.add_node({{"mesh", solid}});
  const scene s = load(g);
  ASSERT_EQ(s.cells.size(), 1u);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(s.cells[0].min[axis], (corner{1.0f, 1.0f, -1.0f})[axis], 1e-5);
    EXPECT_NEAR(s.cells[0].max[axis], (corner{5.0f, 4.0f, 1.0f})[axis], 1e-5);
  }
  // Its polygons keep their source ids, and only they are absent.
  const world_geometry flat = flatten(s);
  ASSERT_EQ(s.polygon_count, 5u);
  EXPECT_FALSE(flat.kinds[0].absent);
  EXPECT_TRUE(flat.kinds[1].absent && flat.kinds[2].absent);
  EXPECT_FALSE(flat.kinds[3].absent || flat.kinds[4].absent);
  EXPECT_NE(s.fingerprint, before);
}

TEST(marked_cells, children_are_not_marked) {
  gltf_sketch g = with_a_triangle();
  const int child = g.add_node({{"mesh", add_solid(g)}});
  g.add_node({{"extras", mark}, {"children", {child}}});
  const scene s = load(g);
  EXPECT_EQ(s.cells.size(), 1u);
  EXPECT_FALSE(flatten(s).kinds[1].absent);
}

TEST(marked_cells, each_instance_is_a_cell) {
  gltf_sketch g = with_a_triangle();
  const int places = g.add_positions({0, 0, 0, 10, 0, 0});
  g.add_node({{"mesh", add_solid(g)},
              {"extras", mark},
              {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  const scene s = load(g);
  ASSERT_EQ(s.cells.size(), 2u);
  EXPECT_EQ(s.cells[0].max, (corner{2.0f, 3.0f, 4.0f}));
  EXPECT_EQ(s.cells[1].min, (corner{10.0f, 0.0f, 0.0f}));
}

TEST(marked_cells, a_mark_of_another_type_and_a_mesh_without_triangles_are_warnings) {
  gltf_sketch g = with_a_triangle();
  g.add_node({{"extras", {{"sightcell", {{"cell", "hall"}}}}}});
  g.add_node({{"mesh", g.add_mesh(g.add_positions({0, 0, 0, 1, 1, 1}), -1, 1)}, {"extras", mark}});
  const scene s = load(g);
  EXPECT_TRUE(s.cells.empty());
  ASSERT_EQ(s.warnings.size(), 2u);
  EXPECT_NE(s.warnings[0].find("has a \"cell\" that is not true or false"), std::string::npos);
  EXPECT_NE(s.warnings[1].find("nodes[2] is marked as a view cell, but its mesh has no triangles"), std::string::npos);
}

// A box that an animation moves is no draw that moves.
TEST(marked_cells, a_box_is_neither_animated_nor_in_a_group) {
  gltf_sketch g = with_a_triangle();
  const int node =
      g.add_node({{"mesh", add_solid(g)}, {"extras", {{"sightcell", {{"cell", true}, {"group", "door"}}}}}});
  g.json["animations"] = {{{"channels", {{{"target", {{"node", node}, {"path", "translation"}}}}}}}};
  const scene s = load(g);
  EXPECT_EQ(s.cells.size(), 1u);
  EXPECT_TRUE(s.groups.empty());
  EXPECT_FALSE(s.draws[1].moves || s.draws[1].tags.animated);
  EXPECT_TRUE(s.draws[1].tags.never);
  EXPECT_TRUE(s.warnings.empty());
}

}  // namespace
}  // namespace sightcell::scene
