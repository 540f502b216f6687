#include "sightcell/picture/picture.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "errors/error_id.h"
#include "gl_test.h"

namespace {

namespace picture = sightcell::picture;
namespace scene = sightcell::scene;

constexpr std::uint32_t size = 64;

// A scene of walls that stand across the -z axis, seen from the origin.
class walls {
 public:
  // A square at z = -distance, two polygons, facing the origin (or away). Returns its first source id.
  std::uint32_t add(float distance, float half, const scene::material& look, bool facing = true) {
    const float d = -distance;
    std::vector<glm::vec3> corners{{-half, -half, d}, {half, -half, d}, {half, half, d}, {-half, half, d}};
    std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
    if (!facing) indices = {0, 2, 1, 0, 3, 2};
    return add(std::move(corners), std::move(indices), look);
  }
  std::uint32_t add(std::vector<glm::vec3> positions, std::vector<std::uint32_t> indices, const scene::material& look) {
    const auto number = static_cast<std::uint32_t>(scene_.draws.size());
    const std::uint32_t first = polygons_;
    polygons_ += static_cast<std::uint32_t>(indices.size() / 3);
    std::vector<glm::vec2> uvs(positions.size(), glm::vec2(0.5f));
    scene_.materials.push_back(look);
    scene_.geometries.push_back({std::move(positions), std::move(uvs), std::move(indices)});
    scene::draw d;
    d.node = d.mesh = d.material = d.geometry = number;
    scene_.draws.push_back(d);
    return first;
  }
  std::uint32_t add_image(std::vector<std::uint8_t> encoded) {
    scene_.images.push_back({"image", std::move(encoded)});
    return static_cast<std::uint32_t>(scene_.images.size() - 1);
  }
  scene::scene finished() const {
    scene::scene s = scene_;
    scene::finish(s);
    return s;
  }

 private:
  scene::scene scene_;
  std::uint32_t polygons_ = 0;
};

scene::material color(float r, float g, float b, float a = 1.0f) {
  scene::material m;
  m.base_color = {r, g, b, a};
  return m;
}

class picture_test : public sightcell::test::gl_test {
 protected:
  // Draws from the origin along -z.
  picture::image_rgba draw(const walls& w, std::optional<std::vector<std::uint32_t>> ids = std::nullopt) {
    const scene::scene s = w.finished();
    const scene::world_geometry world = scene::flatten(s);
    picture::renderer r(context(), s, world);
    auto drawn = ids ? r.draw({}, size, size, std::span<const std::uint32_t>(*ids)) : r.draw({}, size, size);
    polygons_ = r.polygons_of_last_draw();
    return drawn;
  }
  std::uint64_t polygons_ = 0;
};

using rgb = std::array<int, 3>;

rgb pixel(const picture::image_rgba& p, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* at = &p.pixels[4 * (y * std::size_t{p.width} + x)];
  return {at[0], at[1], at[2]};
}

rgb center(const picture::image_rgba& p) {
  return pixel(p, p.width / 2, p.height / 2);
}

bool is_red(const rgb& c) {
  return c[0] > 100 && c[0] > 2 * c[1] && c[0] > 2 * c[2];
}
bool is_green(const rgb& c) {
  return c[1] > 100 && c[1] > 2 * c[0] && c[1] > 2 * c[2];
}
bool is_sky(const rgb& c) {
  return c[2] > c[1] && c[1] > c[0] && c[0] > 100;
}

const scene::material red = color(1, 0, 0), green = color(0, 1, 0);

TEST_F(picture_test, an_empty_scene_is_sky) {
  const auto p = draw(walls());
  EXPECT_EQ(p.width, size);
  EXPECT_EQ(p.pixels.size(), std::size_t{4} * size * size);
  EXPECT_TRUE(is_sky(center(p)));
  EXPECT_EQ(polygons_, 0u);
}

TEST_F(picture_test, the_nearer_wall_hides_the_farther_one) {
  walls w;
  w.add(2, 1, red);
  w.add(3, 1, green);
  const auto p = draw(w);
  EXPECT_TRUE(is_red(center(p)));
  EXPECT_TRUE(is_sky(pixel(p, 1, 1)));
  EXPECT_EQ(polygons_, 4u);
}

TEST_F(picture_test, only_listed_polygons_are_drawn) {
  walls w;
  w.add(2, 1, red);
  const std::uint32_t back = w.add(3, 1, green);
  EXPECT_TRUE(is_green(center(draw(w, std::vector{back, back + 1}))));
  EXPECT_EQ(polygons_, 2u);
  EXPECT_TRUE(is_sky(center(draw(w, std::vector<std::uint32_t>{}))));
  EXPECT_EQ(polygons_, 0u);
}

TEST_F(picture_test, a_polygon_that_is_not_there_is_refused) {
  walls w;
  w.add(2, 1, red);
  EXPECT_EQ(sightcell::test::error_id([&] { draw(w, std::vector<std::uint32_t>{2}); }), "picture.no-such-polygon");
}

TEST_F(picture_test, leaving_out_what_is_hidden_changes_no_pixel) {
  walls w;
  const std::uint32_t front = w.add(2, 2, red);
  w.add(3, 1, green);
  w.add(2.5f, 1, color(1, 1, 1, 0.5f));
  const auto d = picture::compare(draw(w), draw(w, std::vector{front, front + 1}));
  EXPECT_EQ(d.differing_pixels, 0u);
  EXPECT_EQ(picture::compare(draw(w), draw(w, std::vector{front})).differing_pixels > 0, true);
}

TEST_F(picture_test, single_sided_walls_cannot_be_seen_from_behind) {
  walls w;
  w.add(2, 1, red, false);
  EXPECT_TRUE(is_sky(center(draw(w))));
  scene::material both = red;
  both.double_sided = true;
  walls v;
  v.add(2, 1, both, false);
  EXPECT_TRUE(is_red(center(draw(v))));
}

TEST_F(picture_test, a_mirrored_draw_keeps_its_front) {
  walls w;
  w.add(2, 1, red);
  scene::scene s = w.finished();
  s.draws[0].to_world[0][0] = -1.0;  // x mirrored: the wall covers the same place and still faces the eye
  const scene::world_geometry world = scene::flatten(s);
  picture::renderer r(context(), s, world);
  EXPECT_TRUE(is_red(center(r.draw({}, size, size))));
}

TEST_F(picture_test, mask_drops_what_is_below_the_cutoff) {
  scene::material m = color(1, 0, 0, 0.4f);
  m.alpha = scene::alpha_mode::mask;
  walls w;
  w.add(2, 1, m);
  w.add(3, 1, green);
  EXPECT_TRUE(is_green(center(draw(w))));
  m.alpha_cutoff = 0.3f;
  walls v;
  v.add(2, 1, m);
  v.add(3, 1, green);
  EXPECT_TRUE(is_red(center(draw(v))));
}

TEST_F(picture_test, blend_mixes_with_what_is_behind_wherever_it_lies_in_the_file) {
  scene::material glass = color(1, 0, 0, 0.5f);
  glass.alpha = scene::alpha_mode::blend;
  walls w;
  w.add(2, 1, glass);  // first in the file and nearer
  w.add(3, 1, green);
  const rgb c = center(draw(w));
  EXPECT_GT(c[0], 80);
  EXPECT_GT(c[1], 80);
}

TEST_F(picture_test, alpha_of_an_opaque_material_is_ignored) {
  walls w;
  w.add(2, 1, color(1, 0, 0, 0.2f));
  w.add(3, 1, green);
  EXPECT_TRUE(is_red(center(draw(w))));
}

TEST_F(picture_test, broken_images_are_white) {
  for (const std::vector<std::uint8_t>& bytes :
       {std::vector<std::uint8_t>{}, std::vector<std::uint8_t>{1, 2, 3},
        // A PNG header that promises 2^30 x 2^30 pixels, and a JPEG that ends after its first marker.
        std::vector<std::uint8_t>{0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R', 64,
                                  0,    0,   0,   64,  0,  0,  0,  8,  6, 0, 0, 0,  0,   0,   0,   0},
        std::vector<std::uint8_t>{0xFF, 0xD8, 0xFF, 0xE0}}) {
    walls w;
    scene::material m = red;
    m.base_color_image = w.add_image(bytes);
    w.add(2, 1, m);
    EXPECT_TRUE(is_red(center(draw(w)))) << bytes.size();
  }
}

// A 1 x 1 PNG, RGBA 0 255 0 255.
const std::vector<std::uint8_t> green_png{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0x1f, 0x15, 0xc4, 0x89, 0x00, 0x00, 0x00,
    0x0d, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0xf8, 0xcf, 0xf0, 0x1f, 0x00, 0x04, 0x01, 0x01, 0xff,
    0xae, 0xb5, 0x55, 0xf5, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

TEST_F(picture_test, textures_color_the_polygons) {
  walls w;
  scene::material m = color(1, 1, 1);
  m.base_color_image = w.add_image(green_png);
  w.add(2, 1, m);
  EXPECT_TRUE(is_green(center(draw(w))));
}

TEST_F(picture_test, up_is_up_and_right_is_right) {
  walls w;
  w.add({{0.2f, 0.2f, -1}, {0.6f, 0.2f, -1}, {0.6f, 0.6f, -1}, {0.2f, 0.6f, -1}}, {0, 1, 2, 0, 2, 3}, red);
  const auto p = draw(w);
  EXPECT_TRUE(is_red(pixel(p, 50, 13)));
  EXPECT_TRUE(is_sky(pixel(p, 13, 13)));
  EXPECT_TRUE(is_sky(pixel(p, 50, 50)));
}

TEST_F(picture_test, polygons_around_the_eye_are_cut_at_the_near_plane) {
  walls w;
  // A floor that begins far behind the eye and ends far ahead.
  w.add({{-1e4f, -1, 1e4f}, {1e4f, -1, 1e4f}, {1e4f, -1, -1e4f}, {-1e4f, -1, -1e4f}}, {0, 1, 2, 0, 2, 3}, green);
  const auto p = draw(w);
  EXPECT_TRUE(is_green(pixel(p, size / 2, size - 1)));
  EXPECT_TRUE(is_sky(pixel(p, size / 2, 0)));
}

TEST_F(picture_test, degenerate_polygons_and_corners_that_are_not_finite_are_left_out) {
  walls w;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  w.add({{0, 0, -1}, {1, 0, -1}, {2, 0, -1}, {nan, 0, -1}}, {0, 1, 2, 0, 1, 3}, red);
  w.add(3, 1, green);
  EXPECT_TRUE(is_green(center(draw(w))));
  EXPECT_EQ(polygons_, 2u);
}

TEST_F(picture_test, a_camera_without_direction_or_size_is_refused) {
  const scene::scene s = walls().finished();
  const scene::world_geometry world = scene::flatten(s);
  picture::renderer r(context(), s, world);
  EXPECT_EQ(sightcell::test::error_id([&] { r.draw({{}, glm::vec3(0), {0, 1, 0}, 1.0f}, 8, 8); }), "picture.camera");
  EXPECT_EQ(sightcell::test::error_id([&] { r.draw({}, 0, 8); }), "picture.size");
  EXPECT_NO_THROW(r.draw({{}, {0, -1, 0}, {0, 1, 0}, 1.0f}, 8, 8)) << "looking along up";
}

TEST_F(picture_test, the_same_picture_twice_and_at_another_size_between) {
  walls w;
  w.add(2, 0.7f, red);
  const scene::scene s = w.finished();
  const scene::world_geometry world = scene::flatten(s);
  picture::renderer r(context(), s, world);
  const auto first = r.draw({}, size, size);
  EXPECT_EQ(r.draw({}, 20, 10).width, 20u);
  EXPECT_EQ(r.draw({}, size, size).pixels, first.pixels);
  EXPECT_GE(r.cpu_milliseconds_of_last_draw(), 0.0);
}

}  // namespace
