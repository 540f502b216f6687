#include "hemicube/source_on_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "unit/bake/sampler/scripted_source.h"

namespace sightcell::bake {
namespace {

using test::scripted_source;

pose at(float x) {
  pose p;
  p.eye.x = x;
  return p;
}

// Sees one polygon, whose id is the x of the eye.
void see_own_place(const pose& where, hemicube_view& view) {
  view.seen.push_back({static_cast<std::uint32_t>(where.eye.x), 1, 2});
}

struct made {
  scripted_source* inside = nullptr;
  std::unique_ptr<hemicube_source> source;
};
made make_scripted(std::function<void(const pose&, hemicube_view&)> answer) {
  made m;
  m.source = make_source_on_thread([&] {
    auto inside = std::make_unique<scripted_source>();
    inside->answer = std::move(answer);
    m.inside = inside.get();
    return inside;
  });
  return m;
}

TEST(source_on_thread, answers_each_of_many_threads) {
  std::atomic<int> on_other_threads{0};
  std::thread::id owner;
  made m = make_scripted([&](const pose& where, hemicube_view& view) {
    if (owner == std::thread::id()) owner = std::this_thread::get_id();
    if (owner != std::this_thread::get_id()) ++on_other_threads;
    see_own_place(where, view);
  });
  std::atomic<int> wrong{0};
  std::vector<std::thread> callers;
  for (std::uint32_t t = 0; t < 8; ++t) {
    callers.emplace_back([&, t] {
      for (std::uint32_t i = 0; i < 100; ++i) {
        const std::uint32_t first = 1000 * t + 10 * i, count = 1 + i % 5;
        std::vector<pose> poses;
        for (std::uint32_t k = 0; k < count; ++k) poses.push_back(at(static_cast<float>(first + k)));
        std::vector<hemicube_view> views(count);
        views[0].seen.resize(7);  // old content is overwritten
        m.source->render(poses, views);
        for (std::uint32_t k = 0; k < count; ++k)
          if (views[k].seen.size() != 1 || views[k].seen[0].id != first + k) ++wrong;
      }
    });
  }
  for (std::thread& one : callers) one.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(on_other_threads, 0);
  EXPECT_NE(owner, std::this_thread::get_id());
  EXPECT_EQ(m.inside->poses.size(), 8u * 300);
  EXPECT_EQ(m.source->resolution(), 64u);
  EXPECT_EQ(m.source->device(), "scripted");
  EXPECT_GT(m.source->device_seconds().value_or(0.0), 0.0);
}

TEST(source_on_thread, renders_together_what_waits_at_the_same_time) {
  std::atomic<int> begun{0};
  std::atomic<bool> first{true};
  made m = make_scripted([&](const pose&, hemicube_view&) {
    if (!first.exchange(false)) return;
    while (begun < 4) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  // A caller may need longer than the pause to get from its count to its request, so several tries.
  std::size_t most = 0;
  for (int tries = 0; tries < 50 && most < 3; ++tries) {
    begun = 0;
    first = true;
    m.inside->batches.clear();
    std::vector<std::thread> callers;
    for (int t = 0; t < 4; ++t) {
      callers.emplace_back([&] {
        ++begun;
        hemicube_view view;
        m.source->render(at(1.0f), view);
      });
    }
    for (std::thread& one : callers) one.join();
    for (const std::size_t batch : m.inside->batches) most = std::max(most, batch);
  }
  EXPECT_GE(most, 3u);
}

TEST(source_on_thread, throws_what_its_maker_and_its_source_throw) {
  EXPECT_THROW(make_source_on_thread([]() -> std::unique_ptr<hemicube_source> { throw std::out_of_range("none"); }),
               std::out_of_range);
  made m = make_scripted([](const pose& where, hemicube_view& view) {
    if (where.eye.x < 0.0f) throw std::domain_error("behind");
    see_own_place(where, view);
  });
  hemicube_view view;
  EXPECT_THROW(m.source->render(at(-1.0f), view), std::domain_error);
  m.source->render(at(3.0f), view);
  ASSERT_EQ(view.seen.size(), 1u);
  EXPECT_EQ(view.seen[0].id, 3u);
}

TEST(source_on_thread, makes_and_destroys_on_its_own_thread) {
  struct noted final : hemicube_source {
    explicit noted(std::vector<std::thread::id>& ids) : ids_(ids) { ids_.push_back(std::this_thread::get_id()); }
    ~noted() override { ids_.push_back(std::this_thread::get_id()); }
    void render(std::span<const pose>, std::span<hemicube_view>) override {}
    std::uint32_t resolution() const override { return 64; }
    std::string device() const override { return "noted"; }
    void render_image(const pose&, hemicube_image& image) override {
      ids_.push_back(std::this_thread::get_id());
      image.resolution = 5;
    }
    std::vector<std::thread::id>& ids_;
  };
  std::vector<std::thread::id> ids;
  auto source = make_source_on_thread([&] { return std::make_unique<noted>(ids); });
  hemicube_image image;
  source->render_image(at(0.0f), image);
  EXPECT_EQ(image.resolution, 5u);
  source.reset();
  ASSERT_EQ(ids.size(), 3u);
  EXPECT_NE(ids[0], std::this_thread::get_id());
  EXPECT_EQ(ids[1], ids[0]);
  EXPECT_EQ(ids[2], ids[0]);
}

}  // namespace
}  // namespace sightcell::bake
