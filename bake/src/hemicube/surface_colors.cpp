#include "hemicube/surface_colors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "hemicube/hemicube_faces.h"
#include "sightcell/picture/picture.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t side_limit = 16384;  // of an image, pixels

double linear_of(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

// Converts sRGB bytes to linear light and back.
struct srgb_tables {
  std::array<double, 256> linear;  // linear value of each byte
  std::array<double, 255> up_to;   // linear values from which on byte i + 1 is the nearest
  srgb_tables() {
    for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = linear_of(static_cast<double>(i) / 255.0);
    for (std::size_t i = 0; i < up_to.size(); ++i) up_to[i] = linear_of((static_cast<double>(i) + 0.5) / 255.0);
  }
  std::uint8_t byte(double value) const {
    return static_cast<std::uint8_t>(std::upper_bound(up_to.begin(), up_to.end(), value) - up_to.begin());
  }
  glm::u8vec3 bytes(const glm::dvec3& c) const { return {byte(c.x), byte(c.y), byte(c.z)}; }
};

const srgb_tables& srgb() {
  static const srgb_tables tables;
  return tables;
}

// Index of the texel at an integer texel coordinate, which may be outside of the texture.
std::size_t texel_at(std::int64_t place, std::int64_t size, scene::wrap mode) {
  if (mode == scene::wrap::clamp) return static_cast<std::size_t>(std::clamp<std::int64_t>(place, 0, size - 1));
  const std::int64_t period = mode == scene::wrap::mirror ? 2 * size : size;
  const std::int64_t inside = ((place % period) + period) % period;
  return static_cast<std::size_t>(inside < size ? inside : period - 1 - inside);
}

// The two texels around a coordinate, and the weight of the second.
struct between {
  std::size_t first, second;
  double toward_second;
};

between texels_at(double coordinate, std::uint32_t size, scene::wrap mode) {
  if (!std::isfinite(coordinate)) coordinate = 0.0;
  // Wrapped first, so that each coordinate fits into an integer.
  if (mode == scene::wrap::clamp) coordinate = std::clamp(coordinate, 0.0, 1.0);
  if (mode == scene::wrap::repeat) coordinate -= std::floor(coordinate);
  if (mode == scene::wrap::mirror) coordinate -= 2.0 * std::floor(0.5 * coordinate);
  const double place = coordinate * size - 0.5, below = std::floor(place);
  const auto first = static_cast<std::int64_t>(below);
  return {texel_at(first, size, mode), texel_at(first + 1, size, mode), place - below};
}

glm::dvec3 bilinear(const scene::image_pixels& texture, const glm::dvec2& uv, const scene::material& look) {
  const between x = texels_at(uv.x, texture.width, look.wrap_u), y = texels_at(uv.y, texture.height, look.wrap_v);
  const auto texel = [&](std::size_t column, std::size_t row) {
    const std::uint8_t* at = &texture.rgba[4 * (row * texture.width + column)];
    return glm::dvec3(srgb().linear[at[0]], srgb().linear[at[1]], srgb().linear[at[2]]);
  };
  const auto row = [&](std::size_t at) {
    const glm::dvec3 left = texel(x.first, at);
    return left + (texel(x.second, at) - left) * x.toward_second;
  };
  const glm::dvec3 low = row(y.first);
  return low + (row(y.second) - low) * y.toward_second;
}

}  // namespace

struct surface_colors::surface {
  // The dot products of a direction with these vectors are, up to a common factor, the barycentric weights of the point
  // where it meets the plane of the polygon.
  std::array<glm::dvec3, 3> opposite;
  std::array<glm::dvec2, 3> uvs{};
  std::array<glm::dvec3, 3> colors;  // vertex colors times base color, linear
  const scene::material* look = nullptr;
  const scene::image_pixels* texture = nullptr;
};

surface_colors::surface_colors(const scene::scene& s, const scene::world_geometry& world)
    : scene_(s), world_(world), textures_(s.images.size()) {
  std::vector<std::uint32_t> used;
  for (const scene::material& m : s.materials) {
    if (m.base_color_image < s.images.size()) used.push_back(m.base_color_image);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  tbb::parallel_for(std::size_t{0}, used.size(),
                    [&](std::size_t i) { textures_[used[i]] = scene::decode(s.images[used[i]], side_limit); });
}

surface_colors::surface surface_colors::surface_of(std::uint32_t id, const glm::dvec3& eye) const {
  static const scene::material standard;
  const scene::draw& d = scene_.draws[scene::draw_of(scene_, id)];
  const scene::geometry& g = scene_.geometries[d.geometry];
  surface seen;
  seen.look = d.material < scene_.materials.size() ? &scene_.materials[d.material] : &standard;
  const std::uint32_t image = seen.look->base_color_image;
  if (image < textures_.size() && textures_[image]) seen.texture = &*textures_[image];
  std::array<glm::dvec3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = world_.indices[3 * std::size_t{id} + i], local = vertex - d.base_vertex;
    corners[i] = glm::dvec3(world_.positions[vertex]) - eye;
    if (local < g.uvs.size()) seen.uvs[i] = g.uvs[local];
    seen.colors[i] = glm::dvec3(seen.look->base_color);
    if (local < g.colors.size()) seen.colors[i] *= glm::dvec3(g.colors[local]) / 255.0;
  }
  for (std::size_t i = 0; i < 3; ++i) seen.opposite[i] = glm::cross(corners[(i + 1) % 3], corners[(i + 2) % 3]);
  return seen;
}

glm::u8vec3 surface_colors::color_at(const surface& seen, const glm::dvec3& direction) const {
  std::array<double, 3> weights;
  for (std::size_t i = 0; i < 3; ++i) weights[i] = glm::dot(seen.opposite[i], direction);
  const double side = weights[0] + weights[1] + weights[2] < 0.0 ? -1.0 : 1.0;
  // A line of sight can narrowly miss the polygon that the source drew in its pixel. It gets a color of the edge.
  for (double& w : weights) w = std::max(0.0, w * side);
  const double sum = weights[0] + weights[1] + weights[2];
  for (double& w : weights) w = sum > 0.0 ? w / sum : 1.0 / 3.0;

  glm::dvec3 color(0.0);
  glm::dvec2 uv(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    color += weights[i] * seen.colors[i];
    uv += weights[i] * seen.uvs[i];
  }
  if (seen.texture != nullptr) color *= bilinear(*seen.texture, uv, *seen.look);
  return srgb().bytes(color);
}

glm::u8vec3 surface_colors::color_of(std::uint32_t polygon, const glm::vec3& eye, const glm::vec3& direction) const {
  return color_at(surface_of(polygon, glm::dvec3(eye)), glm::dvec3(direction));
}

glm::u8vec3 surface_colors::sky() {
  return srgb().bytes(glm::dvec3(picture::sky_color));
}

void surface_colors::color(const pose& where, const hemicube_image& image, std::vector<glm::u8vec3>& out) const {
  out.resize(image.ids.size());
  const std::size_t stride = 3 * std::size_t{image.resolution};
  const auto faces = hemicube_faces(where, image.resolution);
  const glm::u8vec3 behind_all = sky();
  const auto color_row = [&](const face_view& face, std::size_t y) {
    const auto part = [](std::size_t at, std::uint32_t first, std::uint32_t size, float low, float high) {
      return static_cast<double>(low) +
             (static_cast<double>(at - first) + 0.5) / size * static_cast<double>(high - low);
    };
    const glm::dvec3 right(face.right);
    const glm::dvec3 row =
        glm::dvec3(face.forward) + part(y, face.y, face.height, face.min_y, face.max_y) * glm::dvec3(face.up);
    surface seen;
    std::uint32_t last = scene::no_index;  // adjacent pixels mostly show the same polygon
    for (std::size_t x = face.x; x < face.x + face.width; ++x) {
      const std::size_t pixel = y * stride + x;
      const std::uint32_t id = image.ids[pixel];
      if (id >= scene_.polygon_count) {
        out[pixel] = behind_all;
        continue;
      }
      if (id != last) seen = surface_of(last = id, glm::dvec3(where.eye));
      out[pixel] = color_at(seen, row + part(x, face.x, face.width, face.min_x, face.max_x) * right);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, image.resolution, 8), [&](const auto& rows) {
    for (std::size_t y = rows.begin(); y != rows.end(); ++y) {
      for (const face_view& face : faces) {
        if (y >= face.y && y < face.y + face.height) color_row(face, y);
      }
    }
  });
}

double mean_color_difference(std::span<const glm::u8vec3> a, std::span<const glm::u8vec3> b) {
  if (a.empty()) return 0.0;
  std::uint64_t sum = 0;  // of all channels
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 3; ++c) sum += static_cast<unsigned>(std::abs(a[i][c] - b[i][c]));
  }
  return static_cast<double>(sum) / (255.0 * 3.0 * static_cast<double>(a.size()));
}

}  // namespace sightcell::bake
