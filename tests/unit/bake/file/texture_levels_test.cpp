// The levels that pictures from a cell can need: densities, bounds against rays, and whole files.
#include "file/texture_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "errors/error_id.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/patch.h"
#include "sightcell/bake/recode.h"
#include "sightcell/bake/shards.h"
#include "sightcell/base/random.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"
#include "unit/format/residency_samples.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;
constexpr double infinite = std::numeric_limits<double>::infinity();

std::array<glm::dvec2, 3> scaled(const std::array<glm::dvec2, 3>& uvs, double u, double v) {
  return {uvs[0] * glm::dvec2(u, v), uvs[1] * glm::dvec2(u, v), uvs[2] * glm::dvec2(u, v)};
}

TEST(texture_levels, densities_of_textures) {
  const triangle half{glm::vec3{5, 0, 0}, {7, 0, 0}, {5, 4, 0}};  // 2 x 4 m
  const std::array<glm::dvec2, 3> whole{glm::dvec2{0, 0}, {1, 0}, {0, 1}};
  const texel_density square = density_of(half, scaled(whole, 512, 1024));
  EXPECT_FLOAT_EQ(square.most, 256.0f);
  EXPECT_FLOAT_EQ(square.least, 256.0f);
  const texel_density stretched = density_of(half, scaled(whole, 64, 1024));
  EXPECT_FLOAT_EQ(stretched.most, 256.0f);
  EXPECT_FLOAT_EQ(stretched.least, 32.0f);
  // In any corner's order and any rotation of the texture.
  const double c = std::cos(0.3), s = std::sin(0.3);
  const auto turned = [&](const glm::dvec2& p) { return glm::dvec2(c * p.x - s * p.y, s * p.x + c * p.y) * 2000.0; };
  const texel_density other =
      density_of({half[1], half[2], half[0]}, {turned({64, 0}), turned({0, 1024}), turned({0, 0})});
  EXPECT_NEAR(static_cast<double>(other.most), 256.0 * 2000.0, 1.0);
  EXPECT_NEAR(static_cast<double>(other.least), 32.0 * 2000.0, 1.0);
  EXPECT_EQ(density_of(half, {}).most, 0.0f) << "one texel everywhere";
  EXPECT_EQ(density_of({half[0], half[0], half[2]}, scaled(whole, 64, 64)).most, 0.0f) << "no area";
  EXPECT_EQ(density_of(half, {glm::dvec2(NAN, 0), {1, 0}, {0, 1}}).most, 0.0f);
}

TEST(texture_levels, numbers_of_levels) {
  constexpr std::uint8_t last = format::level_zero + 4 * 9;  // of 512 texels
  EXPECT_EQ(level_number(infinite, last), format::no_level);
  EXPECT_EQ(level_number(0.0, last), format::finest_level);
  EXPECT_EQ(level_number(1.0, last), format::level_zero);
  EXPECT_EQ(level_number(0.999, last), format::level_zero - 1);
  EXPECT_EQ(level_number(2.0, last), format::level_zero + 4);
  EXPECT_EQ(level_number(3.0, last), format::level_zero + 6);
  EXPECT_EQ(level_number(1e-9, last), format::finest_level);
  EXPECT_EQ(level_number(1e9, last), last);
}

// A texture on a polygon, and a cell with one viewpoint in it.
struct sketched_view {
  triangle corners;
  std::array<glm::dvec2, 3> texels;
  box cell;
  glm::dvec3 eye{0.0}, point{0.0};  // the latter on the polygon

  explicit sketched_view(random_stream& random) {
    const auto number = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random.uniform());
    };
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = random.in_box({-3, -3, -3}, {3, 3, 3});
      texels[k] = {number(0, 900), number(0, 90)};
    }
    cell.min = random.in_box({-4, -4, -4}, {4, 4, 4});
    cell.max = cell.min + random.in_box({0.1f, 0.1f, 0.1f}, {2, 2, 2});
    eye = random.in_box(cell.min, cell.max);
    const double a = number(0, 1), b = number(0, 1 - a);
    point = glm::dvec3(corners[0]) * (1 - a - b) + glm::dvec3(corners[1]) * a + glm::dvec3(corners[2]) * b;
  }
  glm::dvec3 normal() const {
    return glm::normalize(glm::cross(glm::dvec3(corners[1] - corners[0]), glm::dvec3(corners[2] - corners[0])));
  }
  glm::dvec2 texel_of(const glm::dvec3& ray) const {
    const glm::dvec3 a(corners[0]), ab = glm::dvec3(corners[1]) - a, ac = glm::dvec3(corners[2]) - a;
    const glm::dvec3 hit = eye + ray * (glm::dot(normal(), a - eye) / glm::dot(normal(), ray));
    const glm::dvec3 place = glm::inverse(glm::dmat3(ab, ac, normal())) * (hit - a);
    return texels[0] + (texels[1] - texels[0]) * place.x + (texels[2] - texels[0]) * place.y;
  }
  // The texels between two pixels, per radian, for a picture that is turned by an angle around the ray.
  double step_of(double turn, double anisotropy) const {
    constexpr double step = 1e-7;
    const glm::dvec3 ray = glm::normalize(point - eye);
    const glm::dvec3 one =
        glm::normalize(glm::cross(ray, std::abs(ray.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 two = glm::cross(ray, one);
    const glm::dvec3 across = one * std::cos(turn) + two * std::sin(turn),
                     up = two * std::cos(turn) - one * std::sin(turn);
    const double x = glm::length(texel_of(ray + step * across) - texel_of(ray)) / step,
                 y = glm::length(texel_of(ray + step * up) - texel_of(ray)) / step;
    return std::max(x, y) / std::min(std::max(x, y) / std::min(x, y), anisotropy);
  }
};

// The bound is never above what a ray takes, and near it for some.
TEST(texture_levels, no_ray_takes_a_finer_level) {
  random_stream random(7, 0, purpose::importance);
  double nearest = infinite;
  int compared = 0;
  for (int i = 0; i < 20'000; ++i) {
    const sketched_view view(random);
    const double anisotropy = i % 3 == 0 ? 1.0 : i % 3 == 1 ? 4.0 : 16.0;
    const double height = std::abs(glm::dot(view.normal(), view.eye - glm::dvec3(view.corners[0])));
    if (height < 1e-3) continue;
    double highest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 at(corner & 1 ? view.cell.min.x : view.cell.max.x,
                          corner & 2 ? view.cell.min.y : view.cell.max.y,
                          corner & 4 ? view.cell.min.z : view.cell.max.z);
      highest = std::max(highest, std::abs(glm::dot(view.normal(), at - glm::dvec3(view.corners[0]))));
    }
    const double distance = least_distance(view.corners, view.cell.min, view.cell.max);
    ASSERT_LE(distance, glm::distance(view.eye, view.point) * 1.000001);
    const double bound = texels_per_radian(density_of(view.corners, view.texels), distance, highest, anisotropy);
    const double taken = view.step_of(6.28 * static_cast<double>(random.uniform()), anisotropy);
    ASSERT_LE(bound, taken * 1.0001) << i;
    if (distance > 0.0) nearest = std::min(nearest, taken / bound);
    ++compared;
  }
  EXPECT_GT(compared, 19'000);
  EXPECT_LT(nearest, 1.2);
}

TEST(texture_levels, distances_to_boxes) {
  random_stream random(8, 0, purpose::importance);
  int loose = 0;
  for (int i = 0; i < 2'000; ++i) {
    const sketched_view view(random);
    // By points of the box near the nearest one.
    double nearest = infinite;
    glm::vec3 best = view.cell.min;
    for (float reach = 1.0f; reach > 1e-4f; reach *= 0.9f)
      for (int k = 0; k < 12; ++k) {
        const glm::vec3 size = view.cell.max - view.cell.min;
        const glm::vec3 tried =
            reach == 1.0f ? random.in_box(view.cell.min, view.cell.max)
                          : glm::clamp(best + reach * (random.in_box(-size, size)), view.cell.min, view.cell.max);
        const auto found = static_cast<double>(distance_to_triangle(tried, view.corners));
        if (found < nearest) nearest = found, best = tried;
      }
    const double distance = least_distance(view.corners, view.cell.min, view.cell.max);
    EXPECT_LE(distance, nearest + 1e-5) << i;
    if (distance < nearest - 0.02) ++loose;
  }
  EXPECT_LT(loose, 20) << "the points that were tried, or the bound, are not near";
}

// Adds a texture to the draw that begins with a polygon of a tiny scene, over a quad whose corners are the whole image.
void add_texture(scene::scene& s, std::uint32_t polygon, std::uint32_t side, double repeat = 1.0) {
  const scene::draw& d = s.draws[scene::draw_of(s, polygon)];
  scene::texture_uses& all = s.textures;
  all.of_material.resize(s.materials.size());
  all.of_material[d.material].push_back(
      {static_cast<std::uint32_t>(all.textures.size()), 0, glm::dmat2(repeat, 0, 0, repeat)});
  all.textures.push_back({static_cast<std::uint32_t>(2 * all.textures.size()), side, side});
  all.coordinates[{d.mesh, d.primitive}][0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
}

struct traced_textures {
  scene::scene s;
  scene::world_geometry world;
  ray_scene rays;
  std::vector<std::uint32_t> all;

  explicit traced_textures(scene::scene finished)
      : s(std::move(finished)), world(scene::flatten(s)), rays(world, false), all(s.polygon_count) {
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  }
  std::vector<double> from(const viewpoint_region& region, double anisotropy = 1.0) const {
    return texture_levels(s, rays, 0.05f, anisotropy).texels_of(region, all);
  }
};

TEST(texture_levels, of_walls_around_a_cell) {
  tiny_scene tiny;
  const std::uint32_t near = tiny.wall_x(-3, 1, 2), far = tiny.wall_x(9, -1, 2), behind = tiny.wall_x(-5, -1, 2);
  const std::uint32_t floor = tiny.quad({20, -1, 2}, {24, -1, 2}, {24, -1, -2}, {20, -1, -2});
  scene::scene s = tiny.finished();
  for (const std::uint32_t polygon : {near, far, behind}) add_texture(s, polygon, 512);
  add_texture(s, floor, 512, 3.0);
  const traced_textures traced(s);
  const box cell{{-1, -1, -1}, {1, 1, 1}};
  const std::vector<double> texels = traced.from(cell);
  EXPECT_NEAR(texels[0], 2 * 128.0, 1e-3) << "512 texels on 4 m, 2 m away";
  EXPECT_NEAR(texels[1], 8 * 128.0, 1e-3);
  EXPECT_EQ(texels[2], infinite) << "it shows its back";
  // The floor is 19 m away and at most 2 m below: steps in its depth are 9.5 times as long.
  EXPECT_NEAR(texels[3], 19 * 384.0 * std::sqrt(0.5 * (1 + 9.5 * 9.5)), 1.0);
  EXPECT_NEAR(traced.from(cell, 4.0)[3], 19 * 384.0 * std::sqrt(0.5 * (1 + 9.5 * 9.5)) / 4, 1.0);
  EXPECT_NEAR(traced.from(cell, 16.0)[3], 19 * 384.0, 1e-2);
  // A set without the wall does not need its texture.
  const texture_levels levels(traced.s, traced.rays, 0.05f, 1.0);
  const std::vector<std::uint32_t> few{far, far + 1};
  EXPECT_EQ(levels.texels_of(cell, few)[0], infinite);
  EXPECT_NEAR(levels.texels_of(cell, few)[1], 8 * 128.0, 1e-3);
  // Viewpoints are in parts of the box alone.
  const viewpoint_region upper = viewpoint_region::build(cell, [](const box& node, int depth) {
    return depth == 0          ? viewpoint_region::kind::split
           : node.min.x < 0.0f ? viewpoint_region::kind::outside
                               : viewpoint_region::kind::inside;
  });
  EXPECT_NEAR(traced.from(upper)[0], 3 * 128.0, 1e-3);
  // A viewpoint keeps the player radius from walls.
  EXPECT_NEAR(traced.from(box{{-4, -1, -1}, {1, 1, 1}})[0], 0.05 * 0.999 * 128.0, 1e-2);
}

TEST(texture_levels, of_what_the_host_moves_are_the_finest) {
  tiny_scene tiny;
  const std::uint32_t wall = tiny.wall_x(9, -1, 2);
  scene::scene s = tiny.finished();
  add_texture(s, wall, 512);
  s.draws[0].moves = true;
  EXPECT_EQ(traced_textures(s).from(box{{-1, -1, -1}, {1, 1, 1}})[0], 0.0);
}

settings quick_levels() {
  settings how;
  how.source = "cpu";
  how.resolution = 64;
  how.cells_grid = {-8.0f, -2.0f, -8.0f, 8.0f, 2.0f, 8.0f};
  how.cell_size = 8.0f;
  how.file.profile = slack_profile::small;
  return how;
}

class residency_file_test : public testing::Test {
 protected:
  residency_file_test() {
    tiny_scene tiny;
    const std::uint32_t wall = tiny.wall_x(-8.5f, 1, 2), small = tiny.wall_x(8.5f, -1, 0.5f);
    tiny.room_with_pillars();
    s_ = tiny.finished();
    add_texture(s_, wall, 1024);
    add_texture(s_, small, 256);
    how_.file.residency = true;
    how_.file.anisotropy = 4.0f;
    how_.threads = 1;
    (void)bake(s_, how_, path_, true, {});
    bytes_ = test::file_bytes(path_);
  }
  std::vector<std::vector<std::uint8_t>> levels(const std::vector<std::byte>& bytes) {
    format::reader file;
    EXPECT_EQ(format::reader::open(bytes, file), format::status::ok);
    return test::levels_of(file);
  }

  test::fresh_folder folder_;
  std::filesystem::path path_ = folder_ / "out.pvs", other_ = folder_ / "other.pvs";
  scene::scene s_;
  settings how_ = quick_levels();
  std::vector<std::byte> bytes_;
};

TEST_F(residency_file_test, threads_recode_and_resumed_bakes_write_the_same_bytes) {
  const auto own = levels(bytes_);
  ASSERT_GT(own.size(), 2u);
  EXPECT_NE(own.front(), own.back());
  settings how = how_;
  how.threads = 3;
  (void)bake(s_, how, other_, true, {});
  EXPECT_TRUE(test::file_bytes(other_) == bytes_);
  // A bake that is canceled in the section, and resumed.
  int reports = 0;
  const callbacks impatient{
      .on_progress = [&](const progress& now) { return now.phase != bake_phase::writing_file || ++reports > 1; }};
  std::filesystem::remove(other_);
  EXPECT_EQ(bake(s_, how_, other_, true, impatient).result, outcome::cancelled);
  EXPECT_FALSE(std::filesystem::exists(other_));
  const summary sum = bake(s_, how_, other_, false, {});
  EXPECT_EQ(sum.cells_resumed, sum.cells);
  EXPECT_TRUE(test::file_bytes(other_) == bytes_);
  // A file without it, to which recode adds it.
  how.file.residency = false;
  (void)bake(s_, how, other_, true, {});
  const auto without = test::file_bytes(other_);
  recode_settings with;
  with.residency_of = &s_;
  with.anisotropy = 4.0f;
  (void)recode(without, "in.pvs", with, other_);
  EXPECT_TRUE(test::file_bytes(other_) == bytes_);
  (void)recode(bytes_, "in.pvs", with, other_);
  EXPECT_TRUE(test::file_bytes(other_) == bytes_);
}

TEST_F(residency_file_test, recode_and_patch_keep_what_is_known) {
  recode_settings order;
  order.order = polygon_order_kind::per_instance;
  (void)recode(bytes_, "in.pvs", order, other_);
  EXPECT_EQ(levels(test::file_bytes(other_)), levels(bytes_));
  // In a cell with a new polygon, the file does not know of which texture it is.
  test::stored_file stored(bytes_);
  std::uint32_t missing = 0;
  for (const std::uint32_t polygon : stored.set(1)) missing += polygon == missing ? 1 : 0;
  const std::vector<added_polygons> added{{.cell = 1, .first = missing}};
  EXPECT_EQ(patch(bytes_, "in.pvs", added, other_).added, 1u);
  auto expected = levels(bytes_);
  expected[1] = {format::finest_level, format::finest_level};
  EXPECT_EQ(levels(test::file_bytes(other_)), expected);
}

TEST(texture_levels, shards_are_rejected) {
  tiny_scene tiny;
  tiny.room_with_pillars();
  const test::fresh_folder folder;
  settings how = quick_levels();
  how.file.residency = true;
  const auto bake_part = [&] { (void)bake_shard(tiny.finished(), how, folder / "out.pvs", {0, 2, 1}, true, {}); };
  EXPECT_EQ(test::error_id(bake_part), "shard.residency");
}

}  // namespace
}  // namespace sightcell::bake
