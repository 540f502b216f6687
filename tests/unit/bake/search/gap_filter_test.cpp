// The filter between hemicubes and set: what of a batch is tested for cracks, and what stays.
#include "search/gap_filter.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "hemicube/hemicube_faces.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t size = 64;

// Says of every pose what it is told to.
class told_source final : public hemicube_source {
 public:
  std::vector<hemicube_view> answers;
  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override {
    for (std::size_t i = 0; i < poses.size(); ++i) views[i] = answers[i];
  }
  void render_image(const pose&, hemicube_image&) override {}
  std::uint32_t resolution() const override { return size; }
  std::string device() const override { return "told"; }
};

// A wall at z = -3 with an upright crack of a millimeter at x = 0, and quads behind it.
class behind_a_crack : public testing::Test {
 protected:
  void SetUp() override {
    test::tiny_scene tiny;
    wall_ = tiny.quad({-9, -9, -3}, {-0.0005f, -9, -3}, {-0.0005f, 9, -3}, {-9, 9, -3});
    tiny.quad({0.0005f, -9, -3}, {9, -9, -3}, {9, 9, -3}, {0.0005f, 9, -3});
    for (int i = 0; i < 40; ++i) {
      const float z = -5.0f - 0.1f * static_cast<float>(i);
      quads_.push_back(tiny.quad({-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}));
    }
    scene_ = tiny.finished();
    geometry_ = scene::flatten(scene_);
    rays_.emplace(geometry_, false);
    set_.emplace(static_cast<std::uint32_t>(geometry_.kinds.size()));
  }

  // Both look along -z, and the pixel is the middle one of the front face: the one looks through the crack, the other
  // stands behind the wall, where nothing is in the way.
  static pose at_crack() { return {{0.004f, 0, 0}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}}; }
  static pose beyond_wall() { return {{0, 0, -4}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}}; }
  static constexpr std::uint32_t middle = 3 * size * (size / 2) + size / 2;

  std::vector<hemicube_view> filtered(const std::vector<pose>& poses, std::vector<hemicube_view> answers) {
    told_source source;
    source.answers = std::move(answers);
    gap_filter filter(source, *rays_, *set_, 0.05f);
    std::vector<hemicube_view> views(poses.size());
    filter.render(poses, views);
    return views;
  }
  static std::vector<std::uint32_t> ids(const hemicube_view& view) {
    std::vector<std::uint32_t> out;
    for (const seen_polygon& seen : view.seen) out.push_back(seen.id);
    return out;
  }

  std::uint32_t wall_ = 0;
  std::vector<std::uint32_t> quads_;
  scene::scene scene_;
  scene::world_geometry geometry_;
  std::optional<ray_scene> rays_;
  std::optional<cell_set> set_;
};

TEST_F(behind_a_crack, few_pixels_are_tested_and_many_are_not) {
  const std::uint32_t few = quads_[0], many = quads_[1], known = quads_[2];
  set_->add(known, {0, 0, 0});
  const auto views = filtered(
      {at_crack()}, {{{{wall_, 3, middle}, {few, 3, middle}, {many, 4 * size + 1, middle}, {known, 3, middle}}, {}}});
  EXPECT_EQ(ids(views[0]), (std::vector<std::uint32_t>{wall_, many, known}));
  EXPECT_EQ(ids(filtered({beyond_wall()}, {{{{few, 3, middle}}, {}}})[0]), (std::vector<std::uint32_t>{few}));
}

TEST_F(behind_a_crack, a_batch_is_as_one_view_after_another) {
  const std::uint32_t a = quads_[0], b = quads_[1], c = quads_[2];
  const seen_polygon few_a{a, 3, middle}, few_b{b, 3, middle}, few_c{c, 3, middle}, many_c{c, 4 * size + 1, middle};
  // a: crack, seen, crack: out of the first, in the other two. b: cracks only. c: seen by many pixels, then few.
  const std::vector<pose> poses{at_crack(), beyond_wall(), at_crack()};
  const std::vector<hemicube_view> answers{{{few_a, few_b, many_c}, {}}, {{few_a}, {}}, {{few_a, few_b, few_c}, {}}};
  const auto together = filtered(poses, answers);
  EXPECT_EQ(ids(together[0]), (std::vector<std::uint32_t>{c}));
  EXPECT_EQ(ids(together[1]), (std::vector<std::uint32_t>{a}));
  EXPECT_EQ(ids(together[2]), (std::vector<std::uint32_t>{a, c}));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto alone = filtered({poses[i]}, {answers[i]});
    EXPECT_EQ(ids(alone[0]), ids(together[i])) << i;
    set_->add_view(poses[i].eye, alone[0].seen);
  }
}

TEST_F(behind_a_crack, threads_change_nothing) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<pose> poses;
  std::vector<hemicube_view> answers(30);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    poses.push_back(i % 3 == 0 ? at_crack() : beyond_wall());
    for (std::size_t k = 0; k < quads_.size(); ++k)
      if (k % (i + 1) == 0) answers[i].seen.push_back({quads_[k], 3, middle});
  }
  std::vector<std::vector<std::uint32_t>> first;
  for (const int threads : {1, 2, 8}) {
    std::vector<std::vector<std::uint32_t>> out;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      for (const hemicube_view& view : filtered(poses, answers)) out.push_back(ids(view));
    });
    if (first.empty()) first = out;
    EXPECT_EQ(out, first) << threads;
  }
  EXPECT_TRUE(first[0].empty());
  EXPECT_FALSE(first[1].empty());
}

}  // namespace
}  // namespace sightcell::bake
