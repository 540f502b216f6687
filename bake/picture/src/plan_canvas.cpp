#include "plan_canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_easy_font.h>
#pragma GCC diagnostic pop

namespace sightcell::picture {
namespace {

// As stb_easy_font_print() writes it.
struct text_corner {
  float x, y, z;
  std::array<unsigned char, 4> color;
};

std::int64_t whole(float value) {
  return static_cast<std::int64_t>(std::lround(value));
}

}  // namespace

plan_canvas::plan_canvas(std::uint32_t width, std::uint32_t height)
    : image_{width, height, std::vector<std::uint8_t>(4 * std::size_t{width} * height, 255)} {}

void plan_canvas::blend(std::int64_t x, std::int64_t y, const glm::vec3& color, float alpha) {
  if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
  std::uint8_t* pixel = &image_.pixels[4 * (static_cast<std::size_t>(y) * image_.width + static_cast<std::size_t>(x))];
  for (int channel = 0; channel < 3; ++channel) {
    const float before = pixel[channel];
    pixel[channel] = static_cast<std::uint8_t>(before + (255.0f * color[channel] - before) * alpha + 0.5f);
  }
}

void plan_canvas::fill(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, const glm::vec3& color,
                       float alpha) {
  for (std::int64_t y = std::max<std::int64_t>(y0, 0); y < std::min<std::int64_t>(y1, image_.height); ++y)
    for (std::int64_t x = std::max<std::int64_t>(x0, 0); x < std::min<std::int64_t>(x1, image_.width); ++x)
      blend(x, y, color, alpha);
}

void plan_canvas::outline(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, const glm::vec3& color,
                          float alpha) {
  fill(x0, y0, x1, y0 + 1, color, alpha);
  if (y1 - y0 > 1) fill(x0, y1 - 1, x1, y1, color, alpha);
  fill(x0, y0 + 1, x0 + 1, y1 - 1, color, alpha);
  if (x1 - x0 > 1) fill(x1 - 1, y0 + 1, x1, y1 - 1, color, alpha);
}

void plan_canvas::disc(double x, double y, double radius, const glm::vec3& color) {
  const auto low = [&](double center) { return static_cast<std::int64_t>(std::floor(center - radius)); };
  const auto high = [&](double center) { return static_cast<std::int64_t>(std::ceil(center + radius)); };
  for (std::int64_t row = low(y); row <= high(y); ++row)
    for (std::int64_t column = low(x); column <= high(x); ++column) {
      const double dx = static_cast<double>(column) + 0.5 - x, dy = static_cast<double>(row) + 0.5 - y;
      const double inside = radius + 0.5 - std::sqrt(dx * dx + dy * dy);  // pixels: a soft border
      if (inside > 0.0) blend(column, row, color, static_cast<float>(std::min(inside, 1.0)));
    }
}

void plan_canvas::text(std::int64_t x, std::int64_t y, const std::string& line, std::int64_t size,
                       const glm::vec3& color) {
  constexpr std::size_t most_quads_of_letter = 40;
  std::string writable = line;  // the library takes a char*
  std::vector<text_corner> corners(4 * most_quads_of_letter * (line.size() + 1));
  const int quads = stb_easy_font_print(0.0f, 0.0f, writable.data(), nullptr, corners.data(),
                                        static_cast<int>(corners.size() * sizeof(text_corner)));
  for (int quad = 0; quad < quads; ++quad) {
    const text_corner &a = corners[static_cast<std::size_t>(4 * quad)],
                      &b = corners[static_cast<std::size_t>(4 * quad + 2)];
    fill(x + size * whole(a.x), y + size * whole(a.y), x + size * whole(b.x), y + size * whole(b.y), color);
  }
}

std::int64_t text_width(const std::string& line, std::int64_t size) {
  std::string writable = line;
  return size * stb_easy_font_width(writable.data());
}

}  // namespace sightcell::picture
