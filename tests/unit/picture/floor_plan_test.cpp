#include "sightcell/picture/floor_plan.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "sightcell/scene/image.h"
#include "unit/bake/tiny_scene.h"

namespace {

using namespace sightcell;
using picture::floor_plan;
using picture::image_rgba;

// Two storeys of 16 x 16 m at 0 m and 4 m, and a pillar on each: at (4, 4) below, at (-4, -4) above.
scene::world_geometry house() {
  test::tiny_scene scene;
  scene.quad({-8, 0, -8}, {-8, 0, 8}, {8, 0, 8}, {8, 0, -8});
  scene.closed_box({3, 0, 3}, {5, 3.5f, 5});
  scene.closed_box({-8, 3.5f, -8}, {8, 4, 8});
  scene.closed_box({-5, 4, -5}, {-3, 7, -3});
  scene.quad({9, -6, -8}, {9, -6, 8}, {10, -6, 8}, {10, -6, -8});  // a ditch
  return scene::flatten(scene.finished());
}

floor_plan plan_of(float ground) {
  floor_plan plan;
  plan.frame = {-8, -8, 10, 8};
  for (float x = -8; x < 8; x += 4)
    for (float z = -8; z < 8; z += 4) plan.areas.push_back({{x, z, x + 4, z + 4}, ground, 0.0f});
  plan.title = "Floor 1 of 2: 0.0 m, 16 cells";
  plan.legend = {{0.0f, "4 m"}};
  return plan;
}

using rgb = std::array<int, 3>;

rgb at(const image_rgba& image, double x, double z) {
  constexpr double scale = 16.0, border = 2.0;
  const auto column = static_cast<std::size_t>(std::floor((x + 8 + border) * scale));
  const auto row = static_cast<std::size_t>(std::floor((z + 8 + border) * scale));
  const std::uint8_t* pixel = &image.pixels[4 * (row * image.width + column)];
  return {pixel[0], pixel[1], pixel[2]};
}

bool is_blue(const rgb& color) {
  return color[2] > color[0] + 20;
}

TEST(floor_plan, each_storey_shows_its_own_pillar) {
  const scene::world_geometry geometry = house();
  for (const float ground : {0.0f, 4.0f}) {
    const image_rgba image = draw_floor_plan(geometry, plan_of(ground));
    const double own = ground == 0.0f ? 4.2 : -4.2, other = -own;
    const rgb floor = at(image, 1.0, -1.0);
    EXPECT_EQ(at(image, other, other), floor) << ground;
    EXPECT_LT(at(image, own, own)[0] + 40, floor[0]) << "solid, at " << ground;
  }
}

TEST(floor_plan, right_is_x_and_up_is_minus_z) {
  floor_plan plan = plan_of(0.0f);
  plan.areas.resize(1);  // that of the lowest x and z
  plan.areas.push_back({{4, -8, 8, -4}, 0.0f, 1.0f});
  plan.marks = {{-2, 6}};
  const image_rgba image = draw_floor_plan(house(), plan);
  EXPECT_TRUE(is_blue(at(image, -6.1, -6.1)));
  EXPECT_FALSE(is_blue(at(image, -6.1, 6.1)));
  EXPECT_GT(at(image, 6.1, -6.1)[0], at(image, 6.1, -6.1)[2] + 20) << "red for the widest";
  const rgb mark = at(image, -2.0, 6.0);
  EXPECT_GT(mark[0], mark[1] + 150);
}

TEST(floor_plan, walls_are_black_and_depths_dark) {
  floor_plan plan = plan_of(0.0f);
  plan.areas.push_back({{8, -8, 10, 8}, 0.0f, 0.0f});
  const image_rgba image = draw_floor_plan(house(), plan);
  int darkest = 255;
  for (double x = 2.8; x < 3.2; x += 1.0 / 16) darkest = std::min(darkest, at(image, x, 4.7)[0]);
  EXPECT_LT(darkest, 60) << "the side of the pillar";
  EXPECT_LT(at(image, 9.5, 1.0)[1] + 30, at(image, 1.0, 1.0)[1]) << "the ditch";
  EXPECT_GT(at(image, 8.6, 1.0)[0], 200) << "nothing below";
}

TEST(floor_plan, is_a_png_of_the_same_pixels_and_bytes_each_time) {
  const image_rgba image = draw_floor_plan(house(), plan_of(0.0f));
  EXPECT_EQ(draw_floor_plan(house(), plan_of(0.0f)).pixels, image.pixels);
  const auto path = std::filesystem::temp_directory_path() / ("floor_plan_test_" + std::to_string(getpid()) + ".png");
  picture::write_png(path, image);
  std::ifstream in(path, std::ios::binary);
  scene::image encoded;
  encoded.encoded.assign(std::istreambuf_iterator<char>(in), {});
  std::filesystem::remove(path);
  const auto decoded = scene::decode(encoded, 4096);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->width, image.width);
  EXPECT_EQ(decoded->height, image.height);
  EXPECT_EQ(decoded->rgba, image.pixels);
}

TEST(floor_plan, fits_into_4096_pixels) {
  EXPECT_EQ(picture::plan_scale({0, 0, 100, 20}), 16.0);
  EXPECT_EQ(picture::plan_scale({0, 0, 100, 400}), 8.0);
  for (const float side : {129.0f, 507.0f, 509.0f, 1000.0f, 1e5f})
    EXPECT_LE(picture::plan_scale({0, 0, side, 1}) * (static_cast<double>(side) + 4.0), 4096.0) << side;
}

}  // namespace
