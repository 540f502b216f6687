// A merged file and the mesh that goes with it, as a host uses both.
#include "sightcell/bake/pack.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <numeric>

#include "errors/error_id.h"
#include "file/pvs_output.h"
#include "sightcell/bake/bake.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/scene/gltf_sketch.h"
#include "unit/scene/packed_file.h"

namespace sightcell::bake {
namespace {

using nlohmann::json;
using ids = std::vector<std::uint32_t>;

// Rows of triangles with two materials, one mirrored, one that moves.
gltf_sketch rows(float first = 0.0f) {
  gltf_sketch g;
  g.json["materials"] = {json::object(), json::object()};
  for (const int material : {0, 1}) {
    const int mesh = g.add_mesh(g.add_row_of_triangles(30, first));
    g.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0]["material"] = material;
  }
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 1}, {"translation", {0, 2, 0}}});
  g.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  g.add_node({{"mesh", 0}, {"translation", {0, 4, 0}}, {"extras", {{"sightcell", {{"dynamic", true}}}}}});
  return g;
}

class pack_test : public testing::Test {
 protected:
  std::filesystem::path scene_file(const gltf_sketch& sketch, const char* name = "scene.glb") {
    const std::filesystem::path path = folder_ / name;
    const std::string bytes = sketch.glb();
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

  // Three cells side by side, whose sets are what has_polygon says.
  std::vector<std::byte> file_of(const scene::scene& s, host_layout layout) {
    std::vector<cell_record> records(3);
    std::vector<view_cell> cells;
    for (std::uint32_t cell = 0; cell < 3; ++cell) {
      for (std::uint32_t id = 0; id < s.polygon_count; ++id)
        if (id % (cell + 2) == 0 || id / 7 % 3 == cell) records[cell].set.push_back(id);
      const float x = static_cast<float>(cell);
      view_cell& box = cells.emplace_back();
      box.min = {x, 0, 0};
      box.max = {x + 1, 1, 1};
      records[cell].bound_met = true;
    }
    settings how;
    how.margin = 0.0f;
    how.file.layout = layout;
    how.file.profile = slack_profile::exact;
    summary sum;
    const std::filesystem::path path = folder_ / "scene.pvs";
    write_pvs(
        frame_of(s, how, describe(how), cells), [&](std::uint32_t cell) { return records[cell]; }, path, {}, sum);
    return test::file_bytes(path);
  }

  test::fresh_folder folder_;
  std::filesystem::path output_ = folder_ / "packed.glb";
};

// Calls with each cell's lists: source ids and the index list out of stored_indices.
void walk(const std::vector<std::byte>& file, const ids& stored_indices,
          const std::function<void(const ids& polygons, const ids& indices)>& look) {
  sightcell_db* db = nullptr;
  sightcell_view* view = nullptr;
  ASSERT_EQ(sightcell_db_open(file.data(), file.size(), nullptr, &db), SIGHTCELL_OK);
  ASSERT_EQ(sightcell_db_check(db), SIGHTCELL_OK);
  ASSERT_EQ(sightcell_view_create(db, &view), SIGHTCELL_OK);
  for (std::uint32_t cell = 0; cell < sightcell_db_cell_count(db); ++cell) {
    const float eye[3] = {static_cast<float>(cell) + 0.5f, 0.5f, 0.5f};
    sightcell_frame frame;
    ASSERT_EQ(sightcell_view_move(view, eye, &frame), SIGHTCELL_OK);
    ASSERT_EQ(frame.cell, cell);
    ids polygons(frame.polygon_count), indices(3 * std::size_t{frame.polygon_count});
    std::size_t count = 0;
    ASSERT_EQ(sightcell_view_polygons(view, polygons.data(), polygons.size(), &count), SIGHTCELL_OK);
    ASSERT_EQ(sightcell_view_indices(view, stored_indices.data(), indices.data(), indices.size(), &count),
              SIGHTCELL_OK);
    look(polygons, indices);
  }
  sightcell_view_destroy(view);
  sightcell_db_close(db);
}

TEST_F(pack_test, its_index_buffer_is_what_the_runtime_takes) {
  const std::filesystem::path path = scene_file(rows());
  const scene::scene s = scene::load_gltf(path);
  const std::vector<std::byte> file = file_of(s, host_layout::merged);
  const pack_result result = pack(path, -1, file, "scene.pvs", output_);
  EXPECT_EQ(result.polygons, s.polygon_count);
  EXPECT_EQ(result.vertices, 360u);
  EXPECT_EQ(result.groups, 3u);
  EXPECT_EQ(result.moving, 1u);
  const scene::packed_file packed(test::file_bytes(output_));
  EXPECT_EQ(result.bytes, packed.bytes().size());
  ids stored_indices;
  for (std::size_t group = 0; group < result.groups; ++group) {
    const ids slice = packed.indices(group);
    stored_indices.insert(stored_indices.end(), slice.begin(), slice.end());
  }
  const scene::world_geometry world = scene::flatten(s);
  ASSERT_EQ(stored_indices.size(), world.indices.size());
  std::size_t cells = 0;
  walk(file, stored_indices, [&](const ids& polygons, const ids& indices) {
    ++cells;
    ids expected;
    for (const std::uint32_t id : polygons)
      for (std::size_t k = 0; k < 3; ++k) expected.push_back(world.indices[3 * std::size_t{id} + k]);
    EXPECT_EQ(indices, expected);
    EXPECT_GT(polygons.size(), 40u);
  });
  EXPECT_EQ(cells, 3u);
}

TEST_F(pack_test, refuses_what_it_does_not_go_with_and_leaves_what_was_there) {
  const std::filesystem::path path = scene_file(rows()), other = scene_file(rows(0.5f), "other.glb");
  const scene::scene s = scene::load_gltf(path);
  std::ofstream(output_) << "before";
  const std::vector<std::byte> before = test::file_bytes(output_);
  const auto refusal = [&](const std::filesystem::path& from, host_layout layout, const std::filesystem::path& to) {
    return test::error_id([&] { (void)pack(from, -1, file_of(s, layout), "scene.pvs", to); });
  };
  EXPECT_EQ(refusal(other, host_layout::merged, output_), "pvs.other-scene");
  EXPECT_EQ(refusal(path, host_layout::instanced, output_), "pack.instanced");
  EXPECT_EQ(refusal(path, host_layout::merged, folder_ / "no" / "packed.glb"), "pack.not-written");
  EXPECT_EQ(refusal(folder_ / "no.glb", host_layout::merged, output_), "scene.not-found");
  EXPECT_EQ(test::file_bytes(output_), before);
  EXPECT_EQ(refusal(path, host_layout::merged, output_), "");
  EXPECT_NE(test::file_bytes(output_), before);
}

}  // namespace
}  // namespace sightcell::bake
