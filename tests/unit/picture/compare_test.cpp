#include <gtest/gtest.h>

#include "errors/error_id.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"

namespace {

using sightcell::picture::compare;
using sightcell::picture::image_rgba;

image_rgba plain(std::uint32_t width, std::uint32_t height, std::uint8_t value) {
  return {width, height, std::vector<std::uint8_t>(4 * std::size_t{width} * height, value)};
}

TEST(compare_test, equal_pictures_do_not_differ) {
  const auto d = compare(plain(3, 2, 80), plain(3, 2, 80));
  EXPECT_EQ(d.differing_pixels, 0u);
  EXPECT_EQ(d.color_error, 0.0);
  EXPECT_EQ(d.marked.width, 3u);
  EXPECT_EQ(d.marked.pixels[0], d.marked.pixels[1]) << "gray";
}

TEST(compare_test, one_pixel_is_counted_and_marked_red) {
  const image_rgba a = plain(3, 2, 80);
  image_rgba b = a;
  b.pixels[4 * 4 + 1] = 131;  // green of the fifth pixel, 51 more
  const auto d = compare(a, b);
  EXPECT_EQ(d.differing_pixels, 1u);
  EXPECT_NEAR(d.color_error, 51.0 / 255.0 / (6 * 3), 1e-12);
  EXPECT_EQ(d.marked.pixels[4 * 4], 255);
  EXPECT_EQ(d.marked.pixels[4 * 4 + 1], 0);
  EXPECT_NE(d.marked.pixels[4 * 3], 255);
}

TEST(compare_test, black_against_white_is_an_error_of_one) {
  EXPECT_DOUBLE_EQ(compare(plain(2, 2, 0), plain(2, 2, 255)).color_error, 1.0);
}

TEST(compare_test, alpha_does_not_count) {
  image_rgba b = plain(2, 2, 80);
  b.pixels[3] = 1;
  EXPECT_EQ(compare(plain(2, 2, 80), b).differing_pixels, 0u);
}

TEST(compare_test, refuses_different_sizes) {
  EXPECT_EQ(sightcell::test::error_id([] { compare(plain(2, 3, 0), plain(3, 2, 0)); }), "picture.size");
}

}  // namespace
