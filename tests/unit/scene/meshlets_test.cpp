// A scene in meshlets: the cases that tests/cli/meshlets_test.py, which reads all of the table, does not have.
#include "sightcell/scene/meshlets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "errors/error_id.h"
#include "gltf_sketch.h"
#include "packed_file.h"
#include "sightcell/scene/strip.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

struct meshlet_sketch {
  explicit meshlet_sketch(const gltf_sketch& sketch)
      : packer(folder.write("sketch.glb", sketch.glb())),
        result(packer.pack([this](std::uint64_t done, std::uint64_t total) { progress.emplace_back(done, total); },
                           warnings)),
        file(result.glb),
        table(file.view(file.json["extras"]["sightcell"]["meshlets"]["bufferView"].get<std::size_t>())) {}

  float number(std::size_t meshlet, std::size_t offset) const {
    float value = 0.0f;
    std::memcpy(&value, &table.at(32 + 16 * result.primitives + 64 * meshlet + offset), sizeof value);
    return value;
  }

  temporary_folder folder;
  gltf_meshlet_packer packer;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> progress;
  meshlet_scene result;
  packed_file file;
  std::vector<std::byte> table;
};

constexpr std::size_t radius_at = 32, cutoff_at = 60;

TEST(meshlets, primitives_with_extensions_that_refer_to_triangles_have_none) {
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(5);
  g.add_mesh(positions);
  g.add_mesh(positions);
  g.json["meshes"][1]["primitives"][0]["extensions"]["VENDOR_tags"] = {{"first", 1}};
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 1}});
  const meshlet_sketch s(g);
  EXPECT_EQ(s.result.primitives, 1u);
  EXPECT_EQ(s.result.triangles, 5u);
  EXPECT_EQ(s.result.drawn_meshlets, 1u);
  EXPECT_EQ(s.warnings, std::vector<std::string>{"primitives with the extension VENDOR_tags have no meshlets"});
  EXPECT_FALSE(s.file.json["meshes"][1]["primitives"][0].contains("extras"));
  EXPECT_EQ(s.progress, (std::vector<std::pair<std::uint64_t, std::uint64_t>>{{5, 10}, {10, 10}}));
}

TEST(meshlets, what_deforms_or_is_not_finite_may_be_anywhere) {
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(3);
  g.add_mesh(positions);
  g.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", positions}}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  g.add_mesh(g.add_positions({0, 0, 0, 1, 0, 0, 0, nan, 0}));
  g.add_mesh(g.add_positions({2, 3, 4, 2, 3, 4, 2, 3, 4}));
  for (const int mesh : {0, 1, 2}) g.add_node({{"mesh", mesh}});
  const meshlet_sketch s(g);
  ASSERT_EQ(s.result.meshlets, 3u);
  EXPECT_EQ(s.number(0, radius_at), std::numeric_limits<float>::max());
  EXPECT_EQ(s.number(1, radius_at), std::numeric_limits<float>::max());
  EXPECT_LT(s.number(2, radius_at), 1e-30f) << "a point";
  EXPECT_EQ(s.number(2, 20), 2.0f);
  for (const std::size_t meshlet : {0, 1, 2}) EXPECT_EQ(s.number(meshlet, cutoff_at), 1.0f);
}

TEST(meshlets, a_scene_without_polygons_has_an_empty_table) {
  gltf_sketch g;
  g.add_node({{"name", "nothing"}});
  const meshlet_sketch s(g);
  EXPECT_EQ(s.result.meshlets, 0u);
  EXPECT_EQ(s.table.size(), 32u);
}

TEST(meshlets, strip_keeps_the_clusters_of_what_is_left) {
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(4);
  g.add_mesh(positions);
  g.add_mesh(positions);
  const int clusters = g.add_accessor(std::vector<std::uint16_t>{7, 7, 300, 2}, "SCALAR", 5123, 4);
  for (const std::size_t mesh : {0, 1})
    g.json["meshes"][mesh]["primitives"][0]["extras"]["sightcell"]["clusters"] = clusters;
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 1}});
  temporary_folder folder;
  gltf_stripper stripper(folder.write("sketch.glb", g.glb()));
  std::vector<std::string> warnings;
  const packed_file file(stripper.strip({true, false, false, false, false, false, false, false}, warnings).glb);
  const scene left = file.loaded();
  EXPECT_EQ(left.geometries[left.draws[0].geometry].clusters, (std::vector<std::uint32_t>{7, 300, 2}));
  EXPECT_EQ(left.geometries[left.draws[1].geometry].clusters, (std::vector<std::uint32_t>{7, 7, 300, 2}));
}

TEST(meshlets, refuses_what_a_glb_cannot_hold) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(1));
  g.add_node({{"mesh", 0}});
  g.add_more_than_a_glb_holds();
  EXPECT_EQ(test::error_id([&] { meshlet_sketch{g}; }), "pack.too-large");
}

}  // namespace
}  // namespace sightcell::scene
