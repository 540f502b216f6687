#include "sightcell/picture/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "plan_canvas.h"
#include "plan_surface.h"

namespace sightcell::picture {
namespace {

constexpr double border = 2.0;  // meters around the frame
constexpr double most_pixels = 4096.0;
constexpr std::int64_t letter = 2;              // pixels per pixel of a letter
constexpr std::int64_t margin = 10, line = 24;  // pixels
constexpr std::uint32_t narrowest = 640;        // pixels, for the text

constexpr float pale = 0.35f;  // what is away from all areas, which another floor shows

constexpr glm::vec3 paper{1.0f}, ink{0.13f}, inside_color{0.56f, 0.56f, 0.60f}, mark_color{0.85f, 0.0f, 0.55f};

glm::vec3 color_of(float share) {
  return {0.1f + 0.8f * share, 0.35f, 0.9f - 0.8f * share};
}

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

void draw_areas(const floor_plan& plan, const plan_shape& shape, plan_canvas& canvas) {
  const auto pixel = [&](float at, double from) {
    return static_cast<std::int64_t>(std::lround((static_cast<double>(at) - from) * shape.scale));
  };
  std::vector<plan_area> areas = plan.areas;
  const auto size = [](const plan_area& a) {
    return (a.where.max_x - a.where.min_x) * (a.where.max_z - a.where.min_z);
  };
  // Narrow ones over wide ones.
  std::stable_sort(areas.begin(), areas.end(), [&](const auto& a, const auto& b) { return size(a) > size(b); });
  std::set<std::tuple<float, float, float, float>> drawn;
  for (const plan_area& a : areas) {
    if (!drawn.insert({a.where.min_x, a.where.min_z, a.where.max_x, a.where.max_z}).second) continue;
    const std::int64_t x0 = pixel(a.where.min_x, shape.min_x), y0 = pixel(a.where.min_z, shape.min_z);
    const std::int64_t x1 = pixel(a.where.max_x, shape.min_x), y1 = pixel(a.where.max_z, shape.min_z);
    canvas.fill(x0, y0, x1, y1, color_of(a.color), 0.14f);
    canvas.outline(x0, y0, x1, y1, color_of(a.color), 0.50f);
  }
}

// Returns a length in meters that is about 120 pixels and has one digit other than 0.
double bar_length(double scale) {
  double length = std::pow(10.0, std::floor(std::log10(120.0 / scale)));
  for (const double factor : {5.0, 2.0})
    if (length * factor * scale <= 120.0) return length * factor;
  return length;
}

void draw_scale_bar(double scale, std::int64_t top, plan_canvas& canvas, std::int64_t& x) {
  const double length = bar_length(scale);
  const auto pixels = static_cast<std::int64_t>(std::lround(length * scale));
  canvas.fill(x, top + 6, x + pixels, top + 8, ink);
  canvas.fill(x, top + 1, x + 2, top + 13, ink);
  canvas.fill(x + pixels - 2, top + 1, x + pixels, top + 13, ink);
  x += pixels + margin;
  std::string text =
      length >= 1.0 ? std::to_string(std::lround(length)) + " m" : std::to_string(std::lround(100.0 * length)) + " cm";
  canvas.text(x, top, text, letter, ink);
  x += text_width(text, letter) + 2 * margin;
}

void draw_legend(const floor_plan& plan, double scale, std::int64_t top, plan_canvas& canvas) {
  std::int64_t x = margin;
  draw_scale_bar(scale, top, canvas, x);
  for (const plan_key& key : plan.legend) {
    canvas.fill(x, top, x + 14, top + 14, color_of(key.color), 0.20f);
    canvas.outline(x, top, x + 14, top + 14, color_of(key.color), 0.9f);
    canvas.text(x + 20, top, key.text, letter, ink);
    x += 20 + text_width(key.text, letter) + 2 * margin;
  }
  canvas.text(margin, top + line, plan.title, letter, ink);
}

}  // namespace

double plan_scale(const plan_rectangle& frame) {
  const double side = std::max(static_cast<double>(frame.max_x) - static_cast<double>(frame.min_x),
                               static_cast<double>(frame.max_z) - static_cast<double>(frame.min_z));
  double scale = side <= 128.0 ? 16.0 : 8.0;
  while ((side + 2.0 * border) * scale > most_pixels) scale *= 0.5;
  return scale;
}

image_rgba draw_floor_plan(const scene::world_geometry& geometry, const floor_plan& plan) {
  const plan_shape shape = shape_of(plan.frame);
  const auto width = std::max(static_cast<std::uint32_t>(shape.width), narrowest);
  plan_canvas canvas(width, static_cast<std::uint32_t>(shape.height + margin + 2 * line + 2));
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
  draw_areas(plan, shape, canvas);
  for (const plan_mark& mark : plan.marks) {
    const double x = (static_cast<double>(mark.x) - shape.min_x) * shape.scale;
    const double y = (static_cast<double>(mark.z) - shape.min_z) * shape.scale;
    canvas.disc(x, y, 6.5, paper);
    canvas.disc(x, y, 4.5, mark_color);
  }
  canvas.fill(0, shape.height, width, shape.height + 1, ink);
  draw_legend(plan, shape.scale, shape.height + margin, canvas);
  return canvas.take();
}

}  // namespace sightcell::picture
