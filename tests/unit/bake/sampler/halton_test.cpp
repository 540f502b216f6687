#include "sampler/halton.h"

#include <gtest/gtest.h>

#include <array>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

TEST(halton, is_even_and_ends_when_nothing_is_free) {
  const auto places =
      make_face_sampler({.sampler = "halton", .samples = 100}, {4, 4}, random_stream(1, 2, purpose::boundary));
  std::array<int, 4> quarter{};
  for (int i = 0; i < 64; ++i) {
    const auto place = places->next();
    ASSERT_TRUE(place);
    ASSERT_GE(place->x, 0.0f);
    ASSERT_LT(place->x, 1.0f);
    ++quarter[static_cast<std::size_t>((place->x > 0.5f) + 2 * (place->y > 0.5f))];
    places->rendered(*place, {});
  }
  for (const int count : quarter) EXPECT_NEAR(count, 16, 3);
  int asked = 0;
  while (const auto place = places->next()) {
    places->rejected(*place);
    ASSERT_LT(++asked, 5000);
  }
}

}  // namespace
}  // namespace sightcell::bake
