#pragma once
// A picture with rectangles, discs and text.
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <utility>

#include "sightcell/picture/picture.h"

namespace sightcell::picture {

class plan_canvas {
 public:
  // Pixels are white. width, height: pixels.
  plan_canvas(std::uint32_t width, std::uint32_t height);

  // Blends a color over the pixels of [x0, x1) x [y0, y1); what is outside the picture is left out.
  // color: 0 to 1 as stored (sRGB). alpha: 1 covers.
  void fill(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, const glm::vec3& color,
            float alpha = 1.0f);
  void outline(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, const glm::vec3& color, float alpha);
  // radius: pixels.
  void disc(double x, double y, double radius, const glm::vec3& color);
  // Draws a line of text. Letters are 7 * size pixels high; x, y: the upper left corner.
  void text(std::int64_t x, std::int64_t y, const std::string& line, std::int64_t size, const glm::vec3& color);

  image_rgba take() { return std::move(image_); }

 private:
  void blend(std::int64_t x, std::int64_t y, const glm::vec3& color, float alpha);

  image_rgba image_;
};

// Returns the width of a line of text in pixels.
std::int64_t text_width(const std::string& line, std::int64_t size);

}  // namespace sightcell::picture
