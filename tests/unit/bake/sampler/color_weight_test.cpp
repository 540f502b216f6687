#include "sampler/color_weight.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstdlib>

#include "hemicube/cpu/cpu_source.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {
namespace {

// Two walls before a hemicube at the origin that looks toward -z: the near one fills the middle of its front face, the
// far one all of it and more.
class two_walls : public testing::Test {
 protected:
  void SetUp() override {
    wall(2.0f, 1.0f, {1.0f, 0.0f, 0.0f, 1.0f});
    wall(4.0f, 6.0f, {0.0f, 1.0f, 0.0f, 1.0f});
    scene::finish(s_);
    world_ = scene::flatten(s_);
    rays_ = std::make_unique<ray_scene>(world_, false);
    source_ = make_cpu_source(world_, {size, 100.0f});
    colors_ = std::make_unique<surface_colors>(s_, world_);
    source_->render(pose(), view_);
  }

  double difference(const std::vector<std::uint32_t>& ids) {
    cell_set set(4);
    for (const std::uint32_t id : ids) set.add(id, {});
    return color_difference(pose(), view_, *source_, *rays_, *colors_, set);
  }
  static double between(const glm::u8vec3& a, const glm::u8vec3& b) {
    return (std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b)) / (3.0 * 255.0);
  }
  double share(std::uint32_t first) const {  // of the pixels, that the wall with this first polygon covers
    double pixels = 0.0;
    for (const seen_polygon& seen : view_.seen) pixels += seen.id / 2 == first / 2 ? seen.pixels : 0;
    return pixels / (3.0 * size * size);
  }

  static constexpr std::uint32_t size = 64;
  static constexpr std::uint32_t near = 0, far = 2;
  scene::scene s_;
  scene::world_geometry world_;
  std::unique_ptr<ray_scene> rays_;
  std::unique_ptr<hemicube_source> source_;
  std::unique_ptr<surface_colors> colors_;
  hemicube_view view_;

 private:
  void wall(float away, float half, const glm::vec4& color) {
    const auto number = static_cast<std::uint32_t>(s_.draws.size());
    scene::material look;
    look.base_color = color;
    s_.materials.push_back(look);
    s_.geometries.push_back({{{-half, -half, -away}, {half, -half, -away}, {half, half, -away}, {-half, half, -away}},
                             {},
                             {0, 1, 2, 0, 2, 3}});
    scene::draw d;
    d.node = d.mesh = d.material = d.geometry = number;
    s_.draws.push_back(d);
  }
};

const glm::u8vec3 red(255, 0, 0), green(0, 255, 0);

TEST_F(two_walls, nothing_new_is_no_difference) {
  EXPECT_EQ(difference({0, 1, 2, 3}), 0.0);
}

TEST_F(two_walls, what_stands_behind_shows_where_the_front_is_missing) {
  EXPECT_GT(share(near), 0.05);
  EXPECT_NEAR(difference({2, 3}), share(near) * between(red, green), 1e-9);
}

TEST_F(two_walls, the_sky_shows_where_nothing_of_the_set_is) {
  EXPECT_NEAR(difference({0, 1}), share(far) * between(green, surface_colors::sky()), 1e-9);
  EXPECT_NEAR(difference({}),
              share(near) * between(red, surface_colors::sky()) + share(far) * between(green, surface_colors::sky()),
              1e-9);
}

TEST_F(two_walls, threads_change_nothing) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena one(1), eight(8);
  double a = 0.0, b = 1.0;
  one.execute([&] { a = difference({2}); });
  eight.execute([&] { b = difference({2}); });
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace sightcell::bake
