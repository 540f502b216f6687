#include "hemicube/surface_colors.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <utility>

#include "hemicube/cpu/cpu_source.h"
#include "hemicube/hemicube_faces.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"

namespace {

namespace bake = sightcell::bake;
namespace picture = sightcell::picture;
namespace scene = sightcell::scene;
using rgb = glm::u8vec3;

constexpr std::uint32_t size = 64;
constexpr rgb red(255, 0, 0), green(0, 255, 0), blue(0, 0, 255), brown(200, 100, 50), white(255, 255, 255);

// 2 x 2 pixels: red, green; below them blue, brown.
const std::vector<std::uint8_t> four_colors{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd, 0xd4, 0x9a,
    0x73, 0x00, 0x00, 0x00, 0x14, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8, 0xcf, 0xc0, 0xc0,
    0x00, 0xc2, 0x0c, 0xff, 0x4f, 0xa4, 0x18, 0x01, 0x00, 0x1d, 0x46, 0x04, 0x5c, 0x20, 0x56, 0x82,
    0x74, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

glm::dvec3 linear_of(const rgb& c) {
  const auto one = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return {one(c.r / 255.0), one(c.g / 255.0), one(c.b / 255.0)};
}
rgb bytes_of(const glm::dvec3& c) {
  const auto one = [](double v) {
    const double srgb = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * std::min(srgb, 1.0)));
  };
  return {one(c.x), one(c.y), one(c.z)};
}

// Adds a double-sided quad over which the image lies once, its upper left corner at a, clockwise to the viewer.
scene::draw& add(scene::scene& s, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, scene::material look,
                 float uv_from = 0.0f, float uv_to = 1.0f) {
  const auto number = static_cast<std::uint32_t>(s.draws.size());
  look.double_sided = true;
  s.materials.push_back(std::move(look));
  s.geometries.push_back(
      {{a, b, c, d}, {{uv_from, uv_from}, {uv_to, uv_from}, {uv_to, uv_to}, {uv_from, uv_to}}, {0, 2, 1, 0, 3, 2}});
  scene::draw made;
  made.node = made.mesh = made.material = made.geometry = number;
  s.draws.push_back(made);
  return s.draws.back();
}
// It fills the front face of the default pose.
scene::draw& add_wall(scene::scene& s, scene::material look, float uv_from = 0.0f, float uv_to = 1.0f) {
  return add(s, {-2, 2, -2}, {2, 2, -2}, {2, -2, -2}, {-2, -2, -2}, std::move(look), uv_from, uv_to);
}

scene::material textured(scene::scene& s, scene::wrap wrap = scene::wrap::clamp) {
  s.images.push_back({"four colors", four_colors});
  scene::material m;
  m.base_color_image = static_cast<std::uint32_t>(s.images.size() - 1);
  m.wrap_u = m.wrap_v = wrap;
  return m;
}

struct seen_scene {
  bake::hemicube_image image;
  std::vector<rgb> colors;
  // Of the front face, y up.
  rgb at(std::uint32_t x, std::uint32_t y) const { return colors[std::size_t{y} * 3 * size + x]; }
};

seen_scene look_at(scene::scene& s, const bake::pose& where = {}) {
  scene::finish(s);
  const scene::world_geometry world = scene::flatten(s);
  seen_scene seen;
  bake::make_cpu_source(world, {size, 100.0f})->render_image(where, seen.image);
  bake::surface_colors(s, world).color(where, seen.image, seen.colors);
  return seen;
}

TEST(surface_colors, texels_lie_where_they_should) {
  scene::scene s;
  add_wall(s, textured(s));
  const seen_scene seen = look_at(s);
  const std::uint32_t low = size / 8, high = size - 1 - size / 8;  // beyond the centers of the texels: clamped
  EXPECT_EQ(seen.at(low, high), red);
  EXPECT_EQ(seen.at(high, high), green);
  EXPECT_EQ(seen.at(low, low), blue);
  EXPECT_EQ(seen.at(high, low), brown);
  // Half red, half green in linear light is 188 of 255 in sRGB; the pixel's center is 1/64 of a texel to the left.
  const rgb middle = seen.at(size / 2 - 1, high);
  EXPECT_NEAR(middle.r, 190, 2);
  EXPECT_NEAR(middle.g, 185, 2);
}

TEST(surface_colors, from_behind_left_is_right) {
  scene::scene s;
  add_wall(s, textured(s));
  const seen_scene seen = look_at(s, {{0, 0, -4}, {0, 0, 1}, {-1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(seen.at(size / 8, size - 9), green);
  EXPECT_EQ(seen.at(size - 9, size / 8), blue);
}

TEST(surface_colors, places_are_right_in_perspective) {
  // A floor from 1 m to 9 m away, red far and blue near: what lies between is not linear on screen.
  scene::scene s;
  add(s, {-9, -1, -9}, {9, -1, -9}, {9, -1, -1}, {-9, -1, -1}, textured(s));
  s.geometries.back().uvs = {{0, 0}, {0, 0}, {0, 1}, {0, 1}};
  const seen_scene seen = look_at(s);
  for (std::uint32_t y = 0; y < 28; ++y) {
    const double away = 1.0 / (1.0 - (y + 0.5) / (size / 2));
    const double blue_part = std::clamp(2.0 * (9.0 - away) / 8.0 - 0.5, 0.0, 1.0);
    const rgb expected = bytes_of({1.0 - blue_part, 0.0, blue_part});
    for (const std::uint32_t x : {20u, 40u}) {
      EXPECT_NEAR(seen.at(x, y).r, expected.r, 1) << y;
      EXPECT_NEAR(seen.at(x, y).b, expected.b, 1) << y;
    }
  }
}

TEST(surface_colors, factor_and_vertex_colors_multiply) {
  scene::scene s;
  scene::material look;
  look.base_color = {0.5f, 1.0f, 0.25f, 1.0f};
  add_wall(s, look);
  s.geometries.back().colors.assign(4, {255, 51, 255, 255});
  const seen_scene seen = look_at(s);
  EXPECT_EQ(seen.at(20, 20), rgb(188, 124, 137));  // 0.5, 0.2 and 0.25 in sRGB
  scene::scene with_texture;
  look = textured(with_texture);
  look.base_color = {0.5f, 1.0f, 1.0f, 1.0f};
  add_wall(with_texture, look);
  EXPECT_EQ(look_at(with_texture).at(4, size - 5), rgb(188, 0, 0));
}

TEST(surface_colors, wrap_modes) {
  // From -1 to 2: three images side by side. Looked up at the texel centers of the first one.
  const auto upper_left = [](scene::wrap wrap) {
    scene::scene s;
    add_wall(s, textured(s, wrap), -1.0f, 2.0f);
    return look_at(s).at(size / 12, size - 1 - size / 12);
  };
  const auto nearly = [](const rgb& a, const rgb& b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 60);  // not in a texel's very center
  };
  nearly(upper_left(scene::wrap::repeat), red);
  nearly(upper_left(scene::wrap::mirror), brown);
  nearly(upper_left(scene::wrap::clamp), red);
  scene::scene s;  // the lower right image: mirrored once more, so that clamp and repeat differ
  add_wall(s, textured(s, scene::wrap::clamp), 1.0f, 2.0f);
  EXPECT_EQ(look_at(s).at(8, size - 9), brown);
}

TEST(surface_colors, without_polygons_or_pixels_of_an_image) {
  scene::scene s;
  scene::material look;
  s.images.push_back({"broken", {1, 2, 3}});
  look.base_color_image = 0;
  add(s, {-1, 1, -2}, {1, 1, -2}, {1, -1, -2}, {-1, -1, -2}, look);
  const seen_scene seen = look_at(s);
  EXPECT_EQ(seen.at(size / 2, size / 2), white);
  EXPECT_EQ(seen.at(0, 0), rgb(162, 196, 234));  // 0.36, 0.55, 0.82
  EXPECT_EQ(seen.colors.back(), seen.at(0, 0));
}

void build(scene::scene& s, bool backwards) {
  const scene::material look = textured(s, scene::wrap::mirror);
  const std::vector<std::function<void()>> parts{
      [&] {
        add(s, {-3, 1, -4}, {0, 2, -5}, {0, -2, -5}, {-3, -2, -4}, look, -1, 3);
      },
      [&] {
        add(s, {0.5f, 2, -3}, {3, 2, -4}, {3, -1, -4}, {0.5f, -1, -3}, look);
      },
      [&] {
        add(s, {-9, -1.5f, -9}, {9, -1.5f, -9}, {9, -1.5f, 1}, {-9, -1.5f, 1}, look, 0, 4);
      }};
  for (std::size_t i = 0; i < parts.size(); ++i) parts[backwards ? parts.size() - 1 - i : i]();
}

TEST(surface_colors, the_order_of_polygons_does_not_matter) {
  scene::scene one, other;
  build(one, false);
  build(other, true);
  const seen_scene a = look_at(one), b = look_at(other);
  EXPECT_NE(a.image.ids, b.image.ids);
  EXPECT_EQ(a.colors, b.colors);
}

TEST(surface_colors, one_line_of_sight_has_the_color_of_its_pixel) {
  scene::scene s;
  build(s, false);
  scene::finish(s);
  const scene::world_geometry world = scene::flatten(s);
  const bake::surface_colors colors(s, world);
  bake::pose where;
  where.eye = {0.3f, 0.2f, 0.5f};
  seen_scene seen;
  bake::make_cpu_source(world, {size, 100.0f})->render_image(where, seen.image);
  colors.color(where, seen.image, seen.colors);
  std::vector<rgb> distinct;
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      const glm::vec3 ray((static_cast<float>(x) + 0.5f) / (size / 2) - 1.0f,
                          (static_cast<float>(y) + 0.5f) / (size / 2) - 1.0f, -1.0f);
      const std::uint32_t id = seen.image.ids[std::size_t{y} * 3 * size + x];
      const rgb one = id == scene::no_index ? bake::surface_colors::sky() : colors.color_of(id, where.eye, 7.0f * ray);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], seen.at(x, y)[c], 1) << x << ' ' << y;
      if (std::find(distinct.begin(), distinct.end(), one) == distinct.end()) distinct.push_back(one);
    }
  }
  EXPECT_GT(distinct.size(), 50u) << "there is something to tell apart";
}

TEST(surface_colors, any_number_of_threads_gives_the_same_bytes) {
  scene::scene s;
  build(s, false);
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 2);
  std::vector<rgb> one, two;
  tbb::task_arena(1).execute([&] { one = look_at(s).colors; });
  tbb::task_arena(2).execute([&] { two = look_at(s).colors; });
  EXPECT_EQ(one, two);
  EXPECT_EQ(one.size(), std::size_t{3} * size * size);
}

TEST(surface_colors, mean_difference) {
  EXPECT_EQ(bake::mean_color_difference({}, {}), 0.0);
  const std::vector<rgb> a{{0, 0, 0}, {10, 20, 30}}, b{{255, 255, 255}, {10, 20, 30}}, c{{0, 51, 0}, {10, 20, 30}};
  EXPECT_EQ(bake::mean_color_difference(a, a), 0.0);
  EXPECT_DOUBLE_EQ(bake::mean_color_difference(a, b), 0.5);
  EXPECT_DOUBLE_EQ(bake::mean_color_difference(c, a), 0.2 / 6.0);
}

// The light and haze of shaders/picture/picture.frag over a base color.
rgb lit(const rgb& base, glm::dvec3 normal, const glm::dvec3& from_eye, double haze_per_metre) {
  const double distance = glm::length(from_eye);
  const glm::dvec3 toward_eye = -from_eye / distance;
  if (glm::dot(normal, toward_eye) < 0.0) normal = -normal;
  const double sun = 0.70 * std::max(glm::dot(normal, glm::dvec3(0.432, 0.792, 0.432)), 0.0);
  const double lamp = 0.12 * glm::dot(normal, toward_eye), up = 0.5 + 0.5 * normal.y;
  const glm::dvec3 sky_light = (1.0 - up) * glm::dvec3(0.16, 0.15, 0.14) + up * glm::dvec3(0.30, 0.34, 0.40);
  const glm::dvec3 color = linear_of(base) * (glm::dvec3(1.0, 0.96, 0.88) * sun + glm::dvec3(lamp) + sky_light);
  const double haze = 1.0 - std::exp(-haze_per_metre * distance);
  return bytes_of((1.0 - haze) * color + haze * glm::dvec3(picture::sky_color));
}

TEST(surface_colors, are_those_of_the_picture) {
  std::unique_ptr<picture::gl_context> context;
  try {
    context = std::make_unique<picture::gl_context>(true);
  } catch (const sightcell::error& e) {
    GTEST_SKIP() << e.what();
  }
  scene::scene s;
  build(s, false);
  const seen_scene seen = look_at(s);
  const scene::world_geometry world = scene::flatten(s);
  picture::renderer renderer(*context, s, world);
  const picture::image_rgba drawn = renderer.draw({{}, {0, 0, -1}, {0, 1, 0}, std::acos(0.0f)}, size, size);

  const double haze = std::min(0.35 / glm::length(glm::dvec3(world.max - world.min)), 0.001);
  std::vector<rgb> expected, found;
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      const std::size_t pixel = std::size_t{y} * 3 * size + x;
      const std::uint8_t* at = &drawn.pixels[4 * ((size - 1 - y) * std::size_t{size} + x)];
      expected.push_back({at[0], at[1], at[2]});
      const std::uint32_t id = seen.image.ids[pixel];
      found.push_back(seen.colors[pixel]);
      if (id == scene::no_index) continue;
      const auto corner = [&](std::size_t i) { return glm::dvec3(world.positions[world.indices[3 * id + i]]); };
      const glm::dvec3 normal = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
      const glm::dvec3 ray((x + 0.5) / (size / 2) - 1.0, (y + 0.5) / (size / 2) - 1.0, -1.0);
      found.back() = lit(found.back(), normal, ray / static_cast<double>(seen.image.inverse_depths[pixel]), haze);
    }
  }
  const double difference = bake::mean_color_difference(expected, found);
  RecordProperty("mean_color_difference", std::to_string(difference));
  // Edges, and the driver's fixed-point texture coordinates and mip levels.
  EXPECT_LT(difference, 0.004);
}

}  // namespace
