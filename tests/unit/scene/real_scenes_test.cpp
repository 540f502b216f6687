// Scenes that nobody here wrote. SIGHTCELL_DATA names their folder.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "sightcell/scene/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

std::filesystem::path data_folder() {
  const char* const named = std::getenv("SIGHTCELL_DATA");
  return named != nullptr ? named : SIGHTCELL_DEFAULT_DATA;
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
  };
  for (const auto& [file, count] : expected) {
    const scene s = load_gltf(data_folder() / file);
    EXPECT_EQ(s.polygon_count, count) << file;
    const world_geometry w = flatten(s);
    EXPECT_EQ(w.kinds.size(), count) << file;
    EXPECT_LT(w.min.x, w.max.x) << file;
  }
}

TEST_F(real_scenes, compressed_ones_are_refused_by_name) {
  for (const char* file : {"draco/candela_city.draco.glb", "meshopt/dream-apartment.glb"}) {
    try {
      load_gltf(data_folder() / file);
      FAIL() << file;
    } catch (const error& e) {
      EXPECT_EQ(e.id(), "scene.extension") << e.what();
    }
  }
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
