#include "sampler/uniform_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

TEST(uniform_grid, has_as_many_places_as_it_may_and_they_are_even) {
  for (const std::uint32_t samples : {1u, 7u, 44u, 45u}) {
    const auto places =
        make_face_sampler({.sampler = "uniform", .samples = samples}, {8, 2}, random_stream(1, 2, purpose::boundary));
    std::vector<glm::vec2> all;
    while (const auto place = places->next()) all.push_back(*place);
    ASSERT_EQ(all.size(), samples);
    float nearest = 100.0f;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, glm::length((all[i] - all[k]) * glm::vec2(8, 2)));
    if (samples >= 44) {
      EXPECT_GT(nearest, 0.4f) << "16 square meters, so squares of 0.6 m";
    }
  }
}

TEST(uniform_grid, the_first_half_covers_the_face) {
  const auto places =
      make_face_sampler({.sampler = "uniform", .samples = 64}, {4, 4}, random_stream(1, 2, purpose::boundary));
  std::array<int, 4> quarter{};
  for (int i = 0; i < 32; ++i) {
    const auto place = places->next();
    ++quarter[static_cast<std::size_t>((place->x > 0.5f) + 2 * (place->y > 0.5f))];
  }
  for (const int count : quarter) EXPECT_EQ(count, 8);
}

}  // namespace
}  // namespace sightcell::bake
