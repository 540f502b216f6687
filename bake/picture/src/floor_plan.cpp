#include "sightcell/picture/floor_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "plan_canvas.h"
#include "plan_surface.h"

namespace sightcell::picture {
namespace {

constexpr double border = 2.0;  // meters around the frame
constexpr double most_pixels = 4096.0;
constexpr std::uint32_t narrowest = 640;  // pixels, for the text

constexpr float pale = 0.35f;  // what is away from all areas, which another floor shows

constexpr glm::vec3 paper{1.0f}, ink{0.13f}, inside_color{0.56f, 0.56f, 0.60f}, mark_color{0.85f, 0.0f, 0.55f};

// From blue over green and orange to red.
glm::vec3 color_of(float share) {
  constexpr std::array<glm::vec3, 4> stops{
      {{0.1f, 0.35f, 0.9f}, {0.0f, 0.6f, 0.4f}, {0.9f, 0.55f, 0.0f}, {0.85f, 0.1f, 0.1f}}};
  const float place = std::clamp(share, 0.0f, 1.0f) * static_cast<float>(stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  return glm::mix(stops[below], stops[below + 1], place - static_cast<float>(below));
}

// Sizes of the text below the map, in pixels.
struct text_sizes {
  explicit text_sizes(std::uint32_t width) : letter(std::clamp<std::int64_t>(width / 700, 2, 5)) {}
  std::int64_t letter;  // per pixel of a letter
  std::int64_t margin() const { return 5 * letter; }
  std::int64_t line() const { return 12 * letter; }
  std::int64_t box() const { return 7 * letter; }
  std::int64_t strip() const { return margin() + 2 * line(); }
};

plan_shape shape_of(const plan_rectangle& frame) {
  plan_shape shape;
  shape.scale = plan_scale(frame);
  shape.min_x = static_cast<double>(frame.min_x) - border;
  shape.min_z = static_cast<double>(frame.min_z) - border;
  const auto pixels = [&](float from, float to) {
    return static_cast<std::int32_t>(
        std::max(std::ceil((static_cast<double>(to) - static_cast<double>(from) + 2.0 * border) * shape.scale), 1.0));
  };
  shape.width = pixels(frame.min_x, frame.max_x);
  shape.height = pixels(frame.min_z, frame.max_z);
  return shape;
}

// Returns the gray of each pixel of the map.
glm::vec3 shade(const plan_surface& surface, const plan_shape& shape, std::int32_t x, std::int32_t y) {
  const auto number = [&](std::int32_t px, std::int32_t py) {
    return static_cast<std::size_t>(py) * static_cast<std::size_t>(shape.width) + static_cast<std::size_t>(px);
  };
  const std::size_t at = number(x, y);
  if ((surface.flags[at] & plan_wall) != 0) return ink;
  if ((surface.flags[at] & plan_inside) != 0) return inside_color;
  const float top = surface.top[at];
  if (top == no_surface) return paper;
  const float depth = std::max(surface.ground[at] - top, 0.0f);
  float gray = 0.52f + 0.42f / (1.0f + 0.16f * depth);  // darker where it is lower
  gray *= 0.66f + 0.40f * static_cast<float>(surface.light[at]) / 255.0f;
  // Edges of crates, ledges and railings.
  const auto ledge = static_cast<float>(0.3 + 1.5 / shape.scale);
  for (const std::size_t other :
       {x + 1 < shape.width ? number(x + 1, y) : at, y + 1 < shape.height ? number(x, y + 1) : at})
    if ((surface.flags[other] & (plan_wall | plan_inside)) == 0 && std::abs(surface.top[other] - top) > ledge)
      gray *= 0.62f;
  return glm::vec3(std::min(gray, 0.97f));
}

// The pixels of an area.
struct pixel_box {
  std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  auto operator<=>(const pixel_box&) const = default;
  std::int64_t size() const { return (x1 - x0) * (y1 - y0); }
};

pixel_box pixels_of(const plan_rectangle& where, const plan_shape& shape) {
  const auto pixel = [&](float at, double from) {
    return static_cast<std::int64_t>(std::lround((static_cast<double>(at) - from) * shape.scale));
  };
  return {pixel(where.min_x, shape.min_x), pixel(where.min_z, shape.min_z), pixel(where.max_x, shape.min_x),
          pixel(where.max_z, shape.min_z)};
}

// Fills a pixel with the color of the narrowest area there: areas of two layers can overlap. Draws all outlines, those
// of narrow areas last.
void draw_areas(const floor_plan& plan, const plan_shape& shape, plan_canvas& canvas) {
  std::map<pixel_box, glm::vec3> colors;
  for (const plan_area& a : plan.areas) colors.emplace(pixels_of(a.where, shape), color_of(a.color));
  std::vector<std::pair<pixel_box, glm::vec3>> areas(colors.begin(), colors.end());
  std::stable_sort(areas.begin(), areas.end(),
                   [](const auto& a, const auto& b) { return a.first.size() < b.first.size(); });
  std::vector<std::uint8_t> filled(static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height));
  for (const auto& [box, color] : areas)
    for (std::int64_t y = std::max<std::int64_t>(box.y0, 0); y < std::min<std::int64_t>(box.y1, shape.height); ++y)
      for (std::int64_t x = std::max<std::int64_t>(box.x0, 0); x < std::min<std::int64_t>(box.x1, shape.width); ++x) {
        std::uint8_t& done =
            filled[static_cast<std::size_t>(y) * static_cast<std::size_t>(shape.width) + static_cast<std::size_t>(x)];
        if (done == 0) canvas.fill(x, y, x + 1, y + 1, color, 0.18f);
        done = 1;
      }
  std::reverse(areas.begin(), areas.end());
  for (const auto& [box, color] : areas) canvas.outline(box.x0, box.y0, box.x1, box.y1, color, 0.5f);
}

// Returns the longest length in meters that has one digit other than 0 and is at most `most` pixels.
double bar_length(double scale, double most) {
  const double length = std::pow(10.0, std::floor(std::log10(most / scale)));
  for (const double factor : {5.0, 2.0})
    if (length * factor * scale <= most) return length * factor;
  return length;
}

void draw_scale_bar(double scale, const text_sizes& sizes, std::int64_t top, plan_canvas& canvas, std::int64_t& x) {
  const double length = bar_length(scale, 60.0 * static_cast<double>(sizes.letter));
  const auto pixels = static_cast<std::int64_t>(std::lround(length * scale));
  const std::int64_t thick = sizes.letter;
  canvas.fill(x, top + 3 * thick, x + pixels, top + 4 * thick, ink);
  canvas.fill(x, top, x + thick, top + sizes.box(), ink);
  canvas.fill(x + pixels - thick, top, x + pixels, top + sizes.box(), ink);
  x += pixels + sizes.margin();
  const std::string text =
      length >= 1.0 ? std::to_string(std::lround(length)) + " m" : std::to_string(std::lround(100.0 * length)) + " cm";
  canvas.text(x, top, text, sizes.letter, ink);
  x += text_width(text, sizes.letter) + 2 * sizes.margin();
}

void draw_legend(const floor_plan& plan, double scale, const text_sizes& sizes, std::int64_t top, plan_canvas& canvas) {
  std::int64_t x = sizes.margin();
  draw_scale_bar(scale, sizes, top, canvas, x);
  for (const plan_key& key : plan.legend) {
    canvas.fill(x, top, x + sizes.box(), top + sizes.box(), color_of(key.color), 0.3f);
    canvas.outline(x, top, x + sizes.box(), top + sizes.box(), color_of(key.color), 0.9f);
    x += sizes.box() + sizes.margin();
    canvas.text(x, top, key.text, sizes.letter, ink);
    x += text_width(key.text, sizes.letter) + 2 * sizes.margin();
  }
  canvas.text(sizes.margin(), top + sizes.line(), plan.title, sizes.letter, ink);
}

}  // namespace

double plan_scale(const plan_rectangle& frame) {
  const double side = std::max(static_cast<double>(frame.max_x) - static_cast<double>(frame.min_x),
                               static_cast<double>(frame.max_z) - static_cast<double>(frame.min_z));
  double scale = side <= 128.0 ? 16.0 : 8.0;
  while ((side + 2.0 * border) * scale > most_pixels) scale *= 0.5;
  return scale;
}

plan_rectangle plan_extent(const plan_rectangle& frame) {
  const plan_shape shape = shape_of(frame);
  return {static_cast<float>(shape.min_x), static_cast<float>(shape.min_z),
          static_cast<float>(shape.min_x + shape.width / shape.scale),
          static_cast<float>(shape.min_z + shape.height / shape.scale)};
}

image_rgba draw_floor_plan(const scene::world_geometry& geometry, const floor_plan& plan) {
  const plan_shape shape = shape_of(plan.frame);
  const auto map_width = static_cast<std::uint32_t>(shape.width);
  const std::uint32_t width = plan.bare ? map_width : std::max(map_width, narrowest);
  const text_sizes sizes(width);
  plan_canvas canvas(width, static_cast<std::uint32_t>(shape.height + (plan.bare ? 0 : sizes.strip())));
  {
    const plan_surface surface = look_from_above(geometry, shape, plan.areas);
    for (std::int32_t y = 0; y < shape.height; ++y)
      for (std::int32_t x = 0; x < shape.width; ++x) {
        const glm::vec3 color = shade(surface, shape, x, y);
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(shape.width) + static_cast<std::size_t>(x);
        canvas.fill(x, y, x + 1, y + 1, color, (surface.flags[at] & plan_near) != 0 ? 1.0f : pale);
      }
  }
  if (plan.bare) return canvas.take();
  draw_areas(plan, shape, canvas);
  for (const plan_mark& mark : plan.marks) {
    const double x = (static_cast<double>(mark.x) - shape.min_x) * shape.scale;
    const double y = (static_cast<double>(mark.z) - shape.min_z) * shape.scale;
    canvas.disc(x, y, 6.5, paper);
    canvas.disc(x, y, 4.5, mark_color);
  }
  canvas.fill(0, shape.height, width, shape.height + 1, ink);
  draw_legend(plan, shape.scale, sizes, shape.height + sizes.margin(), canvas);
  return canvas.take();
}

}  // namespace sightcell::picture
