#include "textures.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "random.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace sightcell::city {
namespace {

constexpr int side = 64;  // pixels

enum class pattern : std::uint8_t { grain, bricks, tiles, slabs, planks, panes, stripes, leaf, pickets, lettering };

struct recipe {
  pattern kind = pattern::grain;
  double meters = 2.0;  // that one repeat covers
  double roughness = 0.1;
};

recipe recipe_of(surface material) {
  switch (material) {
    case surface::roof_tile:
    case surface::roof_slate:
      return {pattern::tiles, 1.6, 0.12};
    case surface::brick:
      return {pattern::bricks, 1.2, 0.15};
    case surface::stone:
    case surface::pavement:
      return {pattern::slabs, 1.5, 0.1};
    case surface::wood:
    case surface::bark:
      return {pattern::planks, 0.8, 0.2};
    case surface::window:
    case surface::panel_dark:
      return {pattern::panes, 1.2, 0.05};
    case surface::cloth:
    case surface::metal:
    case surface::rust:
      return {pattern::stripes, 0.6, 0.15};
    case surface::foliage:
      return {pattern::leaf, 1.0, 0.15};
    case surface::fence:
      return {pattern::pickets, 1.0, 0.1};
    case surface::sign_red:
    case surface::sign_blue:
    case surface::panel_rose:
    case surface::litter:
      return {pattern::lettering, 1.0, 0.05};
    case surface::road:
    case surface::lawn:
      return {pattern::grain, 1.0, 0.25};
    default:
      return {pattern::grain, 2.0, 0.08};
  }
}

// Brightness and coverage at a pixel, before the roughness.
std::array<double, 2> shade(pattern kind, int x, int y) {
  switch (kind) {
    case pattern::bricks: {
      const int shifted = x + (y / 16 % 2) * 16;
      return {y % 16 < 2 || shifted % 32 < 2 ? 0.65 : 0.9, 1.0};
    }
    case pattern::tiles:
      return {0.6 + 0.4 * ((y % 16) / 15.0) - (x % 16 < 2 ? 0.15 : 0.0), 1.0};
    case pattern::slabs:
      return {x % 32 < 1 || y % 32 < 1 ? 0.6 : 0.93, 1.0};
    case pattern::planks:
      return {x % 16 < 1 ? 0.55 : 0.9, 1.0};
    case pattern::panes:
      return {x % 32 < 3 || y % 32 < 3 ? 1.0 : 0.6, 1.0};
    case pattern::stripes:
      return {x / 8 % 2 == 0 ? 1.0 : 0.75, 1.0};
    case pattern::leaf: {
      // Two arcs that meet at the stem and at the tip.
      const double u = (x + 0.5) / side - 0.5, v = (y + 0.5) / side;
      const double half = 1.7 * v * (1.0 - v);
      return {std::abs(u) < 0.02 ? 0.7 : 0.95, std::abs(u) < half ? 1.0 : 0.0};
    }
    case pattern::pickets: {
      const bool is_bar = x % 8 < 4 || y < 5 || y >= side - 5;
      return {0.9, is_bar ? 1.0 : 0.0};
    }
    case pattern::lettering: {
      const bool is_ink = y % 32 > 8 && y % 32 < 24 && (x * 7 + y / 32 * 5) % 13 < 5 && x % 16 > 2;
      return {is_ink ? 0.45 : 1.0, 1.0};
    }
    default:
      return {0.93, 1.0};
  }
}

void append(void* bytes, void* data, int size) {
  const auto* from = static_cast<const std::uint8_t*>(data);
  auto* to = static_cast<std::vector<std::uint8_t>*>(bytes);
  to->insert(to->end(), from, from + size);
}

texture make_texture(surface material) {
  const recipe r = recipe_of(material);
  random_stream random{0x746578u, static_cast<std::uint64_t>(material)};
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto [light, cover] = shade(r.kind, x, y);
      const double value = std::clamp(light + random.range(-r.roughness, r.roughness), 0.0, 1.0);
      const auto level = static_cast<std::uint8_t>(value * 255.0 + 0.5);
      pixels.insert(pixels.end(), {level, level, level, static_cast<std::uint8_t>(cover * 255.0)});
    }
  }
  texture out;
  if (stbi_write_png_to_func(append, &out.png, side, side, 4, pixels.data(), side * 4) == 0) {
    throw std::runtime_error("a texture could not be encoded");
  }
  return out;
}

}  // namespace

std::vector<texture> make_textures() {
  std::vector<texture> out;
  for (std::size_t i = 0; i < static_cast<std::size_t>(surface::count); ++i) {
    out.push_back(make_texture(static_cast<surface>(i)));
  }
  return out;
}

bool is_cut_out(surface material) {
  return material == surface::foliage || material == surface::fence;
}

std::vector<std::array<float, 2>> texture_coordinates(const primitive& p) {
  std::vector<std::array<float, 2>> out(p.positions.size());
  if (is_cut_out(p.material)) {
    static constexpr std::array<std::array<float, 2>, 4> corners = {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = corners[i % 4];
    return out;
  }
  const double meters = recipe_of(p.material).meters;
  const auto point = [&p](std::uint32_t i) {
    return glm::dvec3(p.positions[i][0], p.positions[i][1], p.positions[i][2]);
  };
  for (std::size_t i = 0; i < p.indices.size(); i += 3) {
    const glm::dvec3 a = point(p.indices[i]);
    const glm::dvec3 n = glm::cross(point(p.indices[i + 1]) - a, point(p.indices[i + 2]) - a);
    const double flat = std::sqrt(n.x * n.x + n.z * n.z);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t index = p.indices[i + k];
      const glm::dvec3 at = point(index);
      glm::dvec2 uv(at.x, at.z);
      // Polygons share vertices only inside a quad, so each vertex gets one answer.
      if (std::abs(n.y) < 2.0 * flat) uv = {(at.x * n.z - at.z * n.x) / flat, -at.y};
      out[index] = {static_cast<float>(uv.x / meters), static_cast<float>(uv.y / meters)};
    }
  }
  return out;
}

}  // namespace sightcell::city
