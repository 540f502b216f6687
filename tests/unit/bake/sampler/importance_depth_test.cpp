#include "sampler/importance_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

TEST(reliability_map, is_one_at_the_sample_and_falls_with_distance) {
  reliability_map map({4, 4});
  map.add_sample({0.5f, 0.5f}, {0, 0, 0, 0});
  EXPECT_GT(map.at(128, 128), 0.9999f);
  EXPECT_LT(map.at(255, 128), map.at(200, 128));
  EXPECT_NEAR(map.at(0, 128), std::exp(-0.25), 0.01);
}

TEST(reliability_map, falls_faster_toward_a_gap) {
  reliability_map map({4, 4});
  std::array<double, 4> gap{};
  gap[toward_right] = 3.0;
  map.add_sample({0.5f, 0.5f}, gap);
  EXPECT_LT(map.at(200, 128), map.at(55, 128));
  EXPECT_GT(map.lowest().place.x, 0.9f);
}

TEST(reliability_map, a_new_largest_importance_rebuilds_the_map) {
  reliability_map small({4, 4});
  small.add_sample({0.25f, 0.5f}, {1, 0, 0, 0});
  const float before = small.at(128, 128);
  small.add_sample({0.9f, 0.5f}, {1000, 0, 0, 0});  // the first one's importance is now next to nothing
  EXPECT_LT(before, 0.1f);
  EXPECT_NEAR(small.at(128, 128), std::exp(-0.25 * 0.25), 0.01);
}

TEST(reliability_map, is_only_ever_raised_by_samples_of_equal_scale) {
  reliability_map map({4, 2});
  map.add_sample({0.3f, 0.3f}, {1, 1, 1, 1});
  std::vector<float> before;
  for (std::uint32_t i = 0; i < 256; ++i) before.push_back(map.at(i, i));
  map.add_sample({0.8f, 0.6f}, {0.5, 1, 0.2, 0});
  for (std::uint32_t i = 0; i < 256; ++i) EXPECT_GE(map.at(i, i), before[i]);
}

TEST(reliability_map, knows_its_lowest_place_and_follows_the_formula) {
  reliability_map map({4, 2});
  random_stream random(3, 3, purpose::verify);
  // As the thesis has it, each texel on its own: distances through the longest side, normalized by the largest sum.
  struct sample {
    glm::vec2 place;
    std::array<double, 4> importance;
  };
  std::vector<sample> samples;
  double largest = 0.0;
  for (int i = 0; i < 12; ++i) {
    const glm::vec2 place{random.uniform(), random.uniform()};
    if (i % 3 == 2) {
      map.exclude(place);
      continue;
    }
    sample s{place, {}};
    for (double& part : s.importance) part = static_cast<double>(random.uniform()) * (1.0 + i);
    samples.push_back(s);
    largest = std::max(largest, *std::max_element(s.importance.begin(), s.importance.end()));
    map.add_sample(place, s.importance);

    float lowest = 2.0f;
    glm::vec2 first{0.0f};
    int differ = 0;
    for (std::uint32_t y = 0; y < reliability_map::map_size; ++y)
      for (std::uint32_t x = 0; x < reliability_map::map_size; ++x) {
        const glm::dvec2 at{(x + 0.5) / 256.0, (y + 0.5) / 256.0};
        if (map.at(x, y) < lowest) lowest = map.at(x, y), first = glm::vec2(at);
        double expected = 0.0;
        for (const sample& one : samples) {
          const double du = at.x - static_cast<double>(one.place.x),
                       dv = (at.y - static_cast<double>(one.place.y)) / 2.0;
          const auto variance = [&](direction k) { return std::max(1.0 - one.importance[k] / largest, 0.02); };
          const double square = du * du + dv * dv, a = du * du / square;
          const double r = a * std::exp(-square / variance(du < 0.0 ? toward_left : toward_right)) +
                           (1.0 - a) * std::exp(-square / variance(dv > 0.0 ? toward_up : toward_down));
          expected = std::max(expected, r);
        }
        const bool same = std::abs(static_cast<double>(map.at(x, y)) - expected) < 1e-6;
        differ += same || map.at(x, y) == 1.0f ? 0 : 1;  // 1: taken out of the search
      }
    EXPECT_EQ(differ, 0) << i;
    EXPECT_EQ(map.lowest().reliability, lowest);
    EXPECT_EQ(map.lowest().place, first);
  }
}

TEST(importance_depth, starts_with_the_grid_then_goes_where_reliability_is_lowest) {
  importance_depth sampler({4, 4}, {.sampler = "importance-depth", .samples = 16});
  std::vector<glm::vec2> places;
  for (int i = 0; i < 10; ++i) {
    const auto place = sampler.next();
    ASSERT_TRUE(place);
    if (i >= 9) {
      EXPECT_EQ(*place, sampler.map().lowest().place);
    }
    places.push_back(*place);
    hemicube_view view;
    view.importance = {1, 1, 1, 1};
    sampler.rendered(*place, view);
  }
  EXPECT_EQ(places[0], glm::vec2(1.0f / 6, 1.0f / 6));
  EXPECT_EQ(places[4], glm::vec2(0.5f, 0.5f));
}

TEST(importance_depth, samples_gather_where_the_gap_is) {
  // Half the face sees gaps to the right, half sees a flat wall.
  importance_depth sampler({4, 4}, {.sampler = "importance-depth", .samples = 40});
  int in_gap = 0;
  for (int i = 0; i < 40; ++i) {
    const auto place = sampler.next();
    if (!place) break;
    hemicube_view view;
    if (place->x > 0.5f) view.importance = {1, 1, 1, 1};
    sampler.rendered(*place, view);
    in_gap += place->x > 0.5f;
  }
  EXPECT_GT(in_gap, 24);
}

TEST(importance_depth, ends_when_nothing_is_free) {
  importance_depth sampler({4, 2}, {.sampler = "importance-depth", .samples = 10});
  int asked = 0;
  while (const auto place = sampler.next()) {
    sampler.rejected(*place);
    ASSERT_LT(++asked, 5000);
  }
}

}  // namespace
}  // namespace sightcell::bake
