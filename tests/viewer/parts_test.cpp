// Floors of the map, what is in view, blended polygons in order, paths.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include "blended_order.h"
#include "camera_path.h"
#include "cell_floors.h"
#include "sightcell/base/error.h"
#include "view_volume.h"

namespace viewer {
namespace {

namespace scene = sightcell::scene;

cell cell_of(float x, float y, float z, float side = 4.0f) {
  return {{x, y, z}, {x + side, y + 2.0f, z + side}, {}, {}};
}

TEST(cell_floors, a_slope_is_one_floor_and_a_storey_another) {
  std::vector<cell> cells;
  for (int i = 0; i < 10; ++i) cells.push_back(cell_of(4.0f * static_cast<float>(i), static_cast<float>(i), 0));
  cells.push_back(cell_of(0, 5, 0));     // over the foot of the slope
  cells.push_back(cell_of(0, 12, 0));    // and over that
  cells.push_back(cell_of(100, 30, 0));  // alone: of the first map
  const std::vector<map_floor> floors = floors_of(cells);
  ASSERT_EQ(floors.size(), 3u);
  EXPECT_EQ(floors[0].cells.size(), 11u);
  EXPECT_EQ(floors[1].cells, (std::vector<std::uint32_t>{10}));
  EXPECT_EQ(floors[2].cells, (std::vector<std::uint32_t>{11}));
  EXPECT_TRUE(floors_of({}).empty());
}

TEST(view_volume, keeps_what_is_before_the_camera) {
  fly_camera camera;  // toward -Z
  const view_volume volume(camera, 1.5f);
  EXPECT_TRUE(volume.touches({-1, -1, -5}, {1, 1, -4}));
  EXPECT_TRUE(volume.touches({-1, -1, -1}, {1, 1, 1})) << "around the eye";
  EXPECT_FALSE(volume.touches({-1, -1, 4}, {1, 1, 5}));
  EXPECT_FALSE(volume.touches({50, -1, -5}, {51, 1, -4}));
  EXPECT_FALSE(volume.touches({-1, 50, -5}, {1, 51, -4}));
}

// Quads along z, two polygons each, one draw; and a list of all of them.
struct row {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  std::vector<sightcell_draw> draws;
};

row row_of(std::initializer_list<float> depths, std::uint32_t material_of_last) {
  row out;
  for (const float z : depths) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    out.positions.insert(out.positions.end(), {{-1, -1, z}, {1, -1, z}, {1, 1, z}});
    sightcell_draw d{};
    d.first_source = d.first_stored = static_cast<std::uint32_t>(out.indices.size() / 3);
    d.polygon_count = 1;
    for (const std::uint32_t k : {0u, 1u, 2u}) out.indices.push_back(first + k);
    out.draws.push_back(d);
  }
  out.draws.back().material = material_of_last;
  return out;
}

TEST(polygon_blocks, clip_keeps_places_in_the_list) {
  row r = row_of({-5, 5, -6}, 0);
  const polygon_blocks blocks(r.draws, r.positions, r.indices);
  const std::vector<sightcell_range> ranges{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}};
  std::vector<list_part> kept;
  blocks.clip(parts_of(ranges), view_volume(fly_camera{}, 1.0f), kept);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].at, 0u);
  EXPECT_EQ(kept[1].at, 2u);
  EXPECT_EQ(polygons_in(kept), 2u);
}

TEST(blended_order, the_farthest_comes_first_from_wherever_the_eye_is) {
  const row r = row_of({-3, -9, -6, -7}, 1);  // the last one is opaque
  scene::scene s;
  s.materials.resize(2);
  s.materials[0].alpha = scene::alpha_mode::blend;
  const draw_groups groups(s, r.draws);
  blended_order order(groups, r.draws, r.positions, r.indices);
  const std::vector<sightcell_range> all{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}};
  order.add(parts_of(all), 0);
  const auto stored_from = [&](const glm::vec3& eye) {
    std::vector<std::uintptr_t> out;
    for (const blended_run& run : order.sorted(eye)) {
      for (std::size_t i = 0; i < run.stretches.counts.size(); ++i) {
        const auto first = reinterpret_cast<std::uintptr_t>(run.stretches.offsets[i]) / 12;
        for (std::uintptr_t k = 0; k < static_cast<std::uintptr_t>(run.stretches.counts[i] / 3); ++k)
          out.push_back(first + k);
      }
    }
    return out;
  };
  EXPECT_EQ(stored_from({0, 0, 0}), (std::vector<std::uintptr_t>{1, 2, 0}));
  EXPECT_EQ(stored_from({0, 0, -20}), (std::vector<std::uintptr_t>{0, 2, 1}));
  order.clear();
  EXPECT_TRUE(stored_from({0, 0, 0}).empty());
}

TEST(draw_lists, whole_draws_are_named_once) {
  const row r = row_of({-3, -9}, 0);
  std::vector<sightcell_draw> draws = r.draws;
  draws[1].polygon_count = 7;
  const std::vector<sightcell_range> ranges{{1, 0, 2}, {1, 4, 1}};
  const std::vector<sightcell_range> whole = whole_draws(draws, ranges);
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(whole[0].count, 7u);
}

class camera_path : public testing::Test {
 protected:
  void SetUp() override {
    file_ = (std::filesystem::temp_directory_path() / ("path" + std::to_string(getpid()))).string();
  }
  void TearDown() override { std::filesystem::remove(file_); }
  std::string file_;
};

TEST_F(camera_path, comes_back_bit_by_bit_without_frames_that_stood_still) {
  fly_camera camera;
  path_recorder recorder(file_);
  camera.eye = {0.1f, -1e-7f, 1234.567f};
  camera.yaw = 0.3f;
  recorder.add(0.0, camera);
  recorder.add(0.5, camera);
  camera.pitch = std::numbers::pi_v<float> / 7.0f;
  recorder.add(1.0, camera);
  recorder.finish();
  const std::vector<path_pose> path = read_path(file_);
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(path[1].camera.eye, camera.eye);
  EXPECT_EQ(path[1].camera.yaw, camera.yaw);
  EXPECT_EQ(path[1].camera.pitch, camera.pitch);
  EXPECT_EQ(path[1].seconds, 1.0);
  EXPECT_EQ(thinned(path, 1).size(), 1u);
  EXPECT_EQ(thinned(path, 5).size(), 2u);
}

TEST_F(camera_path, names_the_line_that_is_broken) {
  const auto cause_of = [&](const char* text) {
    std::ofstream(file_, std::ios::binary) << text;
    try {
      (void)read_path(file_);
    } catch (const sightcell::error& e) {
      return std::string(e.what());
    }
    return std::string("read");
  };
  const std::string heading = "seconds,x,y,z,yaw,pitch\n";
  EXPECT_EQ(cause_of((heading + "0,1,2,3,4,5\n").c_str()), "read");
  EXPECT_NE(cause_of("x,y\n").find("does not begin with"), std::string::npos);
  EXPECT_NE(cause_of(heading.c_str()).find("holds no pose"), std::string::npos);
  for (const char* line : {"0,1,2,3,4\n", "0,1,2,3,4,nan\n", "0,1,2,3,4,5,6\n", "0,1,2,3,4,five\n"}) {
    EXPECT_NE(cause_of((heading + "0,1,2,3,4,5\n" + line).c_str()).find("line 3 is no pose"), std::string::npos)
        << line;
  }
  EXPECT_NE(cause_of((heading + "1,1,2,3,4,5\n0,1,2,3,4,5\n").c_str()).find("line 3"), std::string::npos);
}

}  // namespace
}  // namespace viewer
