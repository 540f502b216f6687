// One bit per draw, in both layouts, compared with the polygons of the view.
#include <gtest/gtest.h>

#include "loaded_file.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;

std::vector<bool> draws_of(const std::vector<sightcell_draw>& draws, const std::vector<std::uint32_t>& sources) {
  std::vector<bool> seen(draws.size());
  for (const std::uint32_t source : sources) {
    for (std::size_t d = 0; d < draws.size(); ++d) {
      if (source >= draws[d].first_source && source - draws[d].first_source < draws[d].polygon_count) seen[d] = true;
    }
  }
  return seen;
}

void expect_bits(const sample_contents& contents) {
  const loaded_file file(contents);
  test_view view(file.db());
  std::vector<sightcell_draw> draws(contents.draws.size());
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_draws(file.db(), draws.data(), draws.size(), &count), SIGHTCELL_OK);
  const std::size_t words = (draws.size() + 63) / 64;
  std::size_t set_bits = 0;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& b = contents.cells[cell];
    static_cast<void>(view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2));
    std::vector<std::uint64_t> bits(words + 1, ~std::uint64_t{0});
    ASSERT_EQ(sightcell_view_objects(view.get(), bits.data(), bits.size()), SIGHTCELL_OK);
    const auto expected = draws_of(draws, view.polygons());
    for (std::size_t d = 0; d < 64 * bits.size(); ++d) {
      const bool bit = (bits[d / 64] >> d % 64 & 1) != 0;
      ASSERT_EQ(bit, d < draws.size() && expected[d]) << "cell " << cell << ", draw " << d;
      set_bits += bit ? 1 : 0;
    }
  }
  EXPECT_GT(set_bits, contents.cells.size());
}

TEST(object_bits, instanced) {
  expect_bits(random_contents(31, {.polygons = 800, .draws = 100, .cells = 150}));
  sample_contents shared = random_contents(32, {.polygons = 800, .draws = 63, .cells = 100});
  put_in_order(shared, 5);
  expect_bits(shared);
}

TEST(object_bits, merged) {
  for (const std::uint32_t seed : {33u, 34u, 35u}) {
    sample_contents contents = random_contents(seed, {.polygons = 800, .draws = 90, .cells = 150, .visible = 0.05});
    put_in_groups(contents, seed);
    expect_bits(contents);
  }
}

TEST(object_bits, under_draw_all_every_bit) {
  const sample_contents contents = random_contents(36, {.polygons = 300, .draws = 70, .cells = 10});
  const loaded_file file(contents);
  test_view view(file.db());
  static_cast<void>(view.move(-1e6f, 0, 0));
  std::vector<std::uint64_t> bits(2);
  ASSERT_EQ(sightcell_view_objects(view.get(), bits.data(), 2), SIGHTCELL_OK);
  EXPECT_EQ(bits[0], ~std::uint64_t{0});
  EXPECT_EQ(bits[1], (std::uint64_t{1} << 6) - 1);
}

TEST(object_bits, too_few_words_and_none) {
  const loaded_file file(random_contents(37, {.polygons = 300, .draws = 70, .cells = 10}));
  const test_view view(file.db());
  std::vector<std::uint64_t> bits(2, 7);
  EXPECT_EQ(sightcell_view_objects(view.get(), bits.data(), 1), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(bits[0], 7u) << "nothing is written";
  EXPECT_EQ(sightcell_view_objects(view.get(), nullptr, 2), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_objects(view.get(), nullptr, 0), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(sightcell_view_objects(nullptr, bits.data(), 2), SIGHTCELL_ERR_ARGUMENT);
  ASSERT_EQ(sightcell_view_objects(view.get(), bits.data(), 2), SIGHTCELL_OK);
  EXPECT_EQ(bits[0] + bits[1], 0u) << "before the first move";
}

}  // namespace
