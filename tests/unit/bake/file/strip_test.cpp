// A scene without what no cell has, and a bake of it.
#include "sightcell/bake/strip.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <set>
#include <tuple>

#include "errors/error_id.h"
#include "sightcell/bake/bake.h"
#include "sightcell/scene/scene.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/scene/gltf_sketch.h"

namespace sightcell::bake {
namespace {

using ids = std::vector<std::uint32_t>;
using corners = std::array<std::tuple<float, float, float>, 3>;

// Adds a mesh: a closed box whose polygons face outward, or into it. Polygons 0 and 1 are at z = low, 2 and 3 at z =
// high, 4 to 7 at y = low and high, 8 and 9 at x = low, 10 and 11 at x = high.
int add_box(gltf_sketch& g, std::array<float, 3> low, std::array<float, 3> high, bool inward) {
  std::vector<float> positions;
  for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
    for (const int z : {0, 1}) {
      positions.push_back(x == 0 ? low[0] : high[0]);
      positions.push_back(y == 0 ? low[1] : high[1]);
      positions.push_back(z == 0 ? low[2] : high[2]);
    }
  // Corner c of the front z = low is vertex 2 c, that of z = high 2 c + 1.
  std::vector<std::uint16_t> i{0, 4, 2, 0, 6, 4, 1, 3, 5, 1, 5, 7, 0, 2, 3, 0, 3, 1,
                               6, 7, 5, 6, 5, 4, 0, 1, 7, 0, 7, 6, 2, 4, 5, 2, 5, 3};
  if (inward)
    for (std::size_t k = 0; k < i.size(); k += 3) std::swap(i[k], i[k + 1]);
  const int vertices = g.add_positions(positions);
  return g.add_mesh(vertices, g.add_accessor(i, "SCALAR", 5123, i.size()));
}

// A room with a cell in its middle, and a hollow crate on either side of the cell, both of the same two meshes.
gltf_sketch room_with_crates() {
  gltf_sketch g;
  const int room = add_box(g, {-4, 0, -4}, {4, 4, 4}, true);
  const int crate = add_box(g, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, false);
  const int inside = add_box(g, {-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f}, true);
  g.add_node({{"mesh", room}, {"name", "room"}});
  for (const float x : {-3.0f, 3.0f}) {
    const int next = static_cast<int>(g.json["nodes"].size());
    g.add_node({{"mesh", crate}, {"name", "crate"}, {"translation", {x, 2, 0}}, {"children", {next + 1}}});
    g.add_node({{"mesh", inside}, {"name", "inside"}});
  }
  g.json["scenes"] = {{{"nodes", {0, 1, 3}}}};
  return g;
}

settings one_cell() {
  settings how;
  how.cells = {{"", {-1, 0.5f, -2}, {1, 3.5f, 2}}};
  how.margin = 0.1f;
  how.resolution = 128;
  how.max_pixel_error = 1e-3;
  how.file.profile = slack_profile::exact;
  return how;
}

class strip_test : public testing::Test {
 protected:
  std::filesystem::path scene_file(const gltf_sketch& sketch, const char* name) {
    const std::filesystem::path path = folder_ / name;
    const std::string bytes = sketch.glb();
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }
  std::vector<std::byte> baked(const std::filesystem::path& scene_path) {
    const std::filesystem::path path = folder_ / "scene.pvs";
    (void)bake(scene::load_gltf(scene_path), one_cell(), path, true, {});
    return test::file_bytes(path);
  }
  // The corners of the polygons in the set of the cell.
  static std::multiset<corners> visible(const std::filesystem::path& scene_path, const std::vector<std::byte>& file) {
    const scene::world_geometry world = scene::flatten(scene::load_gltf(scene_path));
    std::multiset<corners> out;
    for (const std::uint32_t id : test::stored_file(file).set(0)) {
      corners c;
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3& p = world.positions[world.indices[3 * std::size_t{id} + k]];
        c[k] = {p.x, p.y, p.z};
      }
      out.insert(c);
    }
    return out;
  }

  test::fresh_folder folder_;
  std::filesystem::path output_ = folder_ / "stripped.glb";
};

TEST_F(strip_test, a_bake_of_what_is_left_sees_the_same_polygons) {
  const std::filesystem::path path = scene_file(room_with_crates(), "scene.glb");
  const std::vector<std::byte> file = baked(path);
  const strip_result result = strip(path, -1, file, "scene.pvs", output_);
  // The insides of both crates, and of each crate the side away from the cell: x = low of the one at x = -3, x = high
  // of the other.
  ids unseen;
  for (std::uint32_t id = 0; id < result.unseen.polygons; ++id)
    if (result.unseen.is_unseen[id]) unseen.push_back(id);
  EXPECT_EQ(unseen, (ids{20, 21, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35,
                         46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59}));
  // The sides are those of one mesh: each crate needs one of them.
  EXPECT_EQ(result.polygons, 60u - 24u);
  const scene::scene left = scene::load_gltf(output_);
  EXPECT_EQ(left.polygon_count, 36u);
  EXPECT_EQ(left.node_names, (std::vector<std::string>{"room", "crate", "inside", "crate", "inside"}));
  const std::multiset<corners> before = visible(path, file), after = visible(output_, baked(output_));
  EXPECT_EQ(before.size(), 32u);
  EXPECT_EQ(before, after);
  EXPECT_EQ(result.bytes, std::filesystem::file_size(output_));
  EXPECT_EQ(result.bytes_before, std::filesystem::file_size(path));
}

TEST_F(strip_test, without_an_output_only_finds) {
  const std::filesystem::path path = scene_file(room_with_crates(), "scene.glb");
  const strip_result result = strip(path, -1, baked(path), "scene.pvs", {});
  EXPECT_EQ(result.unseen.unseen, 28u);
  EXPECT_EQ(result.bytes, 0u);
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(strip_test, refuses_another_scene_and_leaves_what_was_there) {
  const std::filesystem::path path = scene_file(room_with_crates(), "scene.glb");
  const std::vector<std::byte> file = baked(path);
  gltf_sketch moved = room_with_crates();
  moved.json["nodes"][1]["translation"][1] = 2.5;
  const std::filesystem::path other = scene_file(moved, "other.glb");
  std::ofstream(output_) << "before";
  const std::vector<std::byte> before = test::file_bytes(output_);
  const auto refusal = [&](const std::filesystem::path& from, const std::filesystem::path& to) {
    return test::error_id([&] { (void)strip(from, -1, file, "scene.pvs", to); });
  };
  EXPECT_EQ(refusal(other, output_), "pvs.other-scene");
  EXPECT_EQ(refusal(path, folder_ / "no" / "stripped.glb"), "strip.not-written");
  EXPECT_EQ(test::file_bytes(output_), before);
  EXPECT_EQ(refusal(path, output_), "");
  EXPECT_NE(test::file_bytes(output_), before);
}

}  // namespace
}  // namespace sightcell::bake
