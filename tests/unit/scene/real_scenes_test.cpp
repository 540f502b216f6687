// Scenes that nobody here wrote. SIGHTCELL_DATA names their folder.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <string>
#include <utility>
#include <vector>

#include "packed_file.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/pack.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

std::filesystem::path data_folder() {
  const char* const named = std::getenv("SIGHTCELL_DATA");
  return named != nullptr ? named : "";
}

class real_scenes : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(data_folder())) {
      GTEST_SKIP() << data_folder() << " is not there; SIGHTCELL_DATA names the folder of real scenes";
    }
  }
};

TEST_F(real_scenes, have_as_many_polygons_as_their_list_says) {
  const std::pair<const char*, std::uint32_t> expected[] = {
      {"city/intel_castle.glb", 1070891},
      {"city/candela_city.glb", 444542},
      {"city/denhaag_01.glb", 41183},
      {"building/ancient_colosseum_labyrinth.glb", 239444},
      {"foliage/temple.glb", 206670},
      {"instancing/temple.instanced.glb", 206670},
      {"features/denhaag_01.quantized.glb", 41183},
      {"levels/accident.glb", 38816},
      {"levels/czest3ctf.glb", 42893},
      {"levels/oacmpctf3.glb", 79173},
      {"draco/LittlestTokyo.glb", 141802},
      {"meshopt/dream-apartment.glb", 177934},
  };
  for (const auto& [file, count] : expected) {
    const scene s = load_gltf(data_folder() / file);
    EXPECT_EQ(s.polygon_count, count) << file;
    const world_geometry w = flatten(s);
    EXPECT_EQ(w.kinds.size(), count) << file;
    EXPECT_LT(w.min.x, w.max.x) << file;
  }
}

// Compression moves corners by its quantum and may order triangles anew; the whole stays.
TEST_F(real_scenes, compressed_ones_are_the_scenes_they_were_made_from) {
  const std::pair<const char*, const char*> pairs[] = {
      {"city/candela_city.glb", "draco/candela_city.draco.glb"},
      {"levels/czest3ctf.glb", "meshopt/czest3ctf.meshopt.glb"},
  };
  for (const auto& [plain, compressed] : pairs) {
    const scene a = load_gltf(data_folder() / plain), b = load_gltf(data_folder() / compressed);
    ASSERT_EQ(a.draws.size(), b.draws.size()) << compressed;
    for (std::size_t i = 0; i < a.draws.size(); ++i) {
      ASSERT_EQ(a.draws[i].polygon_count, b.draws[i].polygon_count) << compressed << " draw " << i;
    }
    const world_geometry wa = flatten(a), wb = flatten(b);
    for (int axis = 0; axis < 3; ++axis) {
      const float slack = 1e-4f * (wa.max[axis] - wa.min[axis]) + 0.01f;
      EXPECT_NEAR(wa.min[axis], wb.min[axis], slack) << compressed;
      EXPECT_NEAR(wa.max[axis], wb.max[axis], slack) << compressed;
    }
    // The area of a scene is that of its triangles, whatever their order.
    const auto area = [](const world_geometry& w) {
      double sum = 0;
      for (std::size_t i = 0; i < w.indices.size(); i += 3) {
        const glm::dvec3 p(w.positions[w.indices[i]]);
        sum += 0.5 * glm::length(glm::cross(glm::dvec3(w.positions[w.indices[i + 1]]) - p,
                                            glm::dvec3(w.positions[w.indices[i + 2]]) - p));
      }
      return sum;
    };
    EXPECT_NEAR(area(wa) / area(wb), 1.0, 1e-3) << compressed;
  }
}

// In the order of a merged file: all corners where flatten() has them, bit for bit.
TEST_F(real_scenes, packed_ones_have_their_polygons_in_stored_order) {
  for (const char* file : {"city/denhaag_01.glb", "levels/czest3ctf.glb", "meshopt/czest3ctf.meshopt.glb",
                           "features/denhaag_01.quantized.glb", "draco/LittlestTokyo.glb", "foliage/temple.glb",
                           "instancing/temple.instanced.glb"}) {
    SCOPED_TRACE(file);
    gltf_packer packer(data_folder() / file);
    const packed_order order = some_order(packer.content());
    std::vector<std::string> warnings;
    const packed_file packed(packer.pack(order, warnings));
    EXPECT_TRUE(warnings.empty());
    expect_flattened(packer.content(), order, packed);
  }
}

TEST_F(real_scenes, every_malformed_file_that_loads_is_packed_or_ends_in_one_line) {
  std::size_t refused = 0, packed = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder() / "malformed")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".glb" && extension != ".gltf") continue;
    SCOPED_TRACE(entry.path());
    try {
      gltf_packer packer(entry.path());
      const packed_order order = some_order(packer.content());
      std::vector<std::string> warnings;
      const packed_file file(packer.pack(order, warnings));
      if (!order.groups.empty()) expect_flattened(packer.content(), order, file);
      ++packed;
    } catch (const error& e) {
      const std::string line = e.what();
      EXPECT_EQ(e.kind(), error_kind::bad_input) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      ++refused;
    }
  }
  EXPECT_EQ(refused + packed, 83u);
  EXPECT_GT(packed, 20u);
}

TEST_F(real_scenes, every_malformed_file_ends_in_one_line_or_a_scene) {
  std::size_t refused = 0, loaded = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder() / "malformed")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".glb" && extension != ".gltf") continue;
    try {
      flatten(load_gltf(entry.path()));
      ++loaded;
    } catch (const error& e) {
      const std::string line = e.what();
      EXPECT_EQ(e.kind(), error_kind::bad_input) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_NE(line.find(entry.path().filename().string()), std::string::npos) << line;
      ++refused;
    }
  }
  EXPECT_EQ(refused + loaded, 83u);
  EXPECT_GT(refused, 20u);
  EXPECT_GT(loaded, 20u);
}

}  // namespace
}  // namespace sightcell::scene
