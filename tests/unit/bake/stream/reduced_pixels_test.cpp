#include "stream/reduced_pixels.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace sightcell::bake {
namespace {

using scene::alpha_use;
using scene::image_pixels;
using pixel = std::array<int, 4>;

image_pixels pixels_of(std::uint32_t width, std::uint32_t height, const std::vector<pixel>& pixels) {
  image_pixels out{width, height, {}};
  for (const pixel& p : pixels)
    for (const int number : p) out.rgba.push_back(static_cast<std::uint8_t>(number));
  return out;
}

pixel at(const image_pixels& from, std::size_t number) {
  pixel out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = from.rgba[4 * number + k];
  return out;
}

TEST(reduced_pixels, pixels_on_a_border_count_on_both_sides) {
  const image_pixels source = pixels_of(3, 1, {{0, 0, 0, 255}, {90, 9, 0, 255}, {255, 0, 3, 255}});
  const image_pixels out = reduced(source, 2, 1, {});
  EXPECT_EQ(at(out, 0), (pixel{30, 3, 0, 255}));
  EXPECT_EQ(at(out, 1), (pixel{200, 3, 2, 255}));
  const image_pixels upright = reduced(pixels_of(1, 3, {{0, 0, 0, 255}, {90, 9, 0, 255}, {255, 0, 3, 255}}), 1, 2, {});
  EXPECT_EQ(upright.rgba, out.rgba);
}

TEST(reduced_pixels, means_of_colors_are_those_of_light) {
  const image_pixels source = pixels_of(2, 1, {{0, 0, 255, 0}, {255, 0, 255, 255}});
  EXPECT_EQ(at(reduced(source, 1, 1, {.is_color = true}), 0), (pixel{188, 0, 255, 255}));
  EXPECT_EQ(at(reduced(source, 1, 1, {.alpha = alpha_use::number}), 0), (pixel{128, 0, 255, 128}));
}

TEST(reduced_pixels, equal_pixels_stay) {
  std::vector<pixel> rows;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 7; ++x) rows.push_back({y, y, 255 - y, y});
  const image_pixels source = pixels_of(7, 256, rows);
  for (const bool is_color : {false, true})
    for (const alpha_use alpha : {alpha_use::number, alpha_use::blended}) {
      const image_pixels out = reduced(source, 3, 256, {.is_color = is_color, .alpha = alpha});
      for (std::size_t y = 0; y < 256; ++y) EXPECT_EQ(at(out, 3 * y + 1), at(source, 7 * y + 3));
    }
}

TEST(reduced_pixels, colors_weigh_as_much_as_they_cover) {
  const image_pixels source = pixels_of(4, 1, {{200, 0, 0, 0}, {30, 160, 40, 255}, {200, 0, 0, 0}, {100, 0, 0, 0}});
  const image_pixels out = reduced(source, 2, 1, {.alpha = alpha_use::blended});
  EXPECT_EQ(at(out, 0), (pixel{30, 160, 40, 128}));
  EXPECT_EQ(at(out, 1), (pixel{150, 0, 0, 0}));  // no color covers anything
}

TEST(reduced_pixels, as_much_passes_an_alpha_test) {
  constexpr std::uint32_t side = 64;
  std::vector<pixel> pixels;
  std::uint32_t state = 1;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    state = state * 1664525u + 1013904223u;
    pixels.push_back(
        {0, 0, 0, static_cast<int>(state >> 24) < 70 ? 230 + static_cast<int>(i % 20) : static_cast<int>(i % 20)});
  }
  const image_pixels source = pixels_of(side, side, pixels);
  const auto passing = [](const image_pixels& image, int least) {
    double out = 0.0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) out += image.rgba[i] >= least ? 1.0 : 0.0;
    return out / (static_cast<double>(image.rgba.size()) / 4.0);
  };
  for (const float cutoff : {0.2f, 0.5f, 0.8f}) {
    const auto least = static_cast<int>(std::ceil(cutoff * 255.0f));
    EXPECT_NEAR(passing(reduced(source, 16, 16, {.alpha = alpha_use::tested, .cutoff = cutoff}), least),
                passing(source, least), 0.01);
  }
  // Everything passes, or nothing.
  for (const float cutoff :
       {-1.0f, 0.0f, 1.5f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    EXPECT_EQ(reduced(source, 16, 16, {.alpha = alpha_use::tested, .cutoff = cutoff}).rgba,
              reduced(source, 16, 16, {.alpha = alpha_use::blended}).rgba);
}

TEST(reduced_pixels, normals_have_length_1) {
  const image_pixels source = pixels_of(2, 1, {{204, 128, 230, 255}, {51, 128, 230, 255}});
  EXPECT_EQ(at(reduced(source, 1, 1, {.has_normals = true}), 0), (pixel{128, 128, 255, 255}));
  // Opposite vectors have no mean.
  const image_pixels opposite = pixels_of(2, 1, {{0, 128, 128, 255}, {255, 127, 127, 255}});
  EXPECT_EQ(at(reduced(opposite, 1, 1, {.has_normals = true}), 0)[3], 255);
}

}  // namespace
}  // namespace sightcell::bake
