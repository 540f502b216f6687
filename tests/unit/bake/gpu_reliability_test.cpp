#include "source/gpu_reliability.h"

#include <algorithm>
#include <cmath>

#include "gpu_scene.h"

namespace {

namespace bake = sightcell::bake;

class gpu_reliability_test : public sightcell::test::gpu_test {};

// Both maps, side by side.
struct two_maps {
  explicit two_maps(const glm::vec2& face) : reference(face), device(face) {}
  void add(const glm::vec2& place, const std::array<double, 4>& importance) {
    reference.add_sample(place, importance);
    device.add_sample(place, importance);
  }
  void exclude(const glm::vec2& place) {
    reference.exclude(place);
    device.exclude(place);
  }
  void expect_same(const std::string& what) {
    constexpr std::uint32_t size = bake::reliability_map::map_size;
    const std::vector<float> values = device.values();
    ASSERT_EQ(values.size(), std::size_t{size} * size);
    float worst = 0.0f;
    for (std::uint32_t y = 0; y < size; ++y)
      for (std::uint32_t x = 0; x < size; ++x)
        worst = std::max(worst, std::abs(values[y * size + x] - reference.at(x, y)));
    EXPECT_LE(worst, 1e-5f) << what;
    // The lowest texel of the reference, or one that is as low but for rounding; the first of its own equals.
    const auto expected = reference.lowest(), found = device.lowest();
    EXPECT_NEAR(found.reliability, expected.reliability, 1e-5f) << what;
    const auto first = std::min_element(values.begin(), values.end());
    EXPECT_EQ(found.reliability, *first) << what;
    EXPECT_EQ(found.place, bake::reliability_map::center_of(static_cast<std::uint32_t>(first - values.begin())))
        << what;
    const auto texel = [](float v) { return static_cast<std::uint32_t>(v * size); };
    EXPECT_NEAR(reference.at(texel(found.place.x), texel(found.place.y)), expected.reliability, 1e-5f) << what;
  }

  bake::reliability_map reference;
  bake::gpu_reliability_map device;
};

TEST_F(gpu_reliability_test, an_empty_map_is_lowest_at_its_first_texel) {
  two_maps maps({4, 2});
  maps.expect_same("empty");
  EXPECT_EQ(maps.device.lowest().reliability, 0.0f);
  EXPECT_EQ(maps.device.lowest().place, bake::reliability_map::center_of(0));
}

TEST_F(gpu_reliability_test, agrees_with_the_reference_for_any_row_of_samples) {
  std::mt19937 engine(9);
  const auto number = [&] { return static_cast<float>(engine() >> 8) / 16777216.0f; };
  for (const glm::vec2 face : {glm::vec2(8, 8), glm::vec2(8.5f, 2.5f), glm::vec2(1, 40)}) {
    two_maps maps(face);
    for (int i = 0; i < 40; ++i) {
      const std::string what = "face " + std::to_string(face.x) + ", step " + std::to_string(i);
      // Now and then a new maximum, which makes the map anew; sides without importance; several at once.
      const double scale = i % 7 == 3 ? 10.0 * (i + 1) : 5.0;
      maps.add({number(), number()}, {scale * number(), i % 5 == 0 ? 0.0 : scale * number(), scale * number(), 0.1});
      if (i % 4 == 1) maps.exclude({number(), number()});
      if (i % 3 != 0) maps.expect_same(what);
    }
  }
}

TEST_F(gpu_reliability_test, chooses_the_places_that_the_sampler_would) {
  two_maps maps({6, 3});
  std::mt19937 engine(4);
  for (int i = 0; i < 30; ++i) {
    const auto expected = maps.reference.lowest(), found = maps.device.lowest();
    EXPECT_NEAR(found.reliability, expected.reliability, 1e-5f);
    const double strength = 1.0 + static_cast<double>(engine() % 9);
    maps.add(expected.place, {strength, 2.0, 10.0 - strength, 0.0});
    maps.expect_same("place " + std::to_string(i));
  }
  EXPECT_GT(maps.device.lowest().reliability, 0.5f);
}

TEST_F(gpu_reliability_test, what_is_excluded_stays_so) {
  two_maps maps({4, 4});
  for (const glm::vec2 place : {glm::vec2(0, 0), glm::vec2(1, 1), glm::vec2(0.5f, 0.25f)}) maps.exclude(place);
  maps.expect_same("excluded");
  EXPECT_EQ(maps.device.values()[0], 1.0f);
  maps.add({0.9f, 0.9f}, {1, 1, 1, 1});
  maps.expect_same("a sample");
  maps.add({0.1f, 0.8f}, {2, 1, 1, 1});
  maps.expect_same("a new maximum");
  EXPECT_EQ(maps.device.values()[0], 1.0f);
}

}  // namespace
