// Several cells in work at once: the same records, every cell told of once, and an orderly end whatever ends it.
#include "job/cell_workers.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

#include "hemicube/hemicube_faces.h"
#include "job/cell_bake.h"
#include "sightcell/base/error.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

// A shared source that casts a ray per pixel, pixels in parallel; on_render is told of every call.
class traced_source final : public hemicube_source {
 public:
  explicit traced_source(const ray_scene& rays) : rays_(rays) {}
  std::function<void(std::span<const pose>)> on_render = [](std::span<const pose>) {};

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override {
    on_render(poses);
    tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) { trace(poses[i], views[i]); });
  }
  void render_image(const pose&, hemicube_image&) override {}
  std::uint32_t resolution() const override { return 16; }
  std::string device() const override { return "traced"; }

 private:
  void trace(const pose& where, hemicube_view& view) const {
    std::map<std::uint32_t, seen_polygon> found;
    sight seen;
    for (std::uint32_t pixel = 0; pixel < 3 * 16 * 16; ++pixel) {
      rays_.trace(where.eye, pixel_direction(where, 16, pixel), seen);
      if (seen.front == no_polygon) continue;
      seen_polygon& one = found.try_emplace(seen.front, seen_polygon{seen.front, 0, pixel}).first->second;
      ++one.pixels;
      view.importance[pixel % 4] += 1.0 / (1.0 + static_cast<double>(seen.distance));
    }
    view.seen.clear();
    for (const auto& [id, one] : found) view.seen.push_back(one);
  }

  const ray_scene& rays_;
};

// A room with pillars in it, and a row of cells.
class cell_workers : public testing::Test {
 protected:
  static constexpr std::uint32_t cell_total = 14;

  void SetUp() override {
    test::tiny_scene tiny;
    tiny.closed_box({-2, -3, -9}, {30, 3, 9}, true);
    for (int i = 0; i < 20; ++i) {
      const float x = 1.5f * static_cast<float>(i), z = i % 2 == 0 ? 2.2f : -2.6f;
      tiny.closed_box({x, -3, z}, {x + 0.4f, 1, z + 0.5f});
    }
    geometry_ = scene::flatten(tiny.finished());
    rays_.emplace(geometry_, false);
    neighbors_.emplace(*rays_);
    source_.emplace(*rays_);
    how_.max_pixel_error = 0.01;
    for (std::uint32_t i = 0; i < cell_total; ++i) {
      const float x = 2.0f * static_cast<float>(i);
      cells_.push_back({{x, 0, -1}, {x + 2, 1, 1}, "", 1000u + i});
      wanted_.push_back(i);
    }
    // A block each, and nobody shares: every cell is one step.
    blocks_.emplace(cells_, how_.margin);
    plan_.emplace(*blocks_, false);
  }

  step_queue queue() const { return step_queue::phase_1(*plan_, stage_table(cells_.size()), wanted_); }

  // Takes all steps of wanted_ on the arena.
  void run(std::size_t lanes, tbb::task_arena& arena, const steps_ended& ended, bool rays = true) {
    settings how = how_;
    if (!rays) how.max_pixel_error = 0.0;
    const auto sampler = make_cell_sampler(how, {*rays_, *source_, nullptr, {}, &*neighbors_});
    const cell_baker baker(how, none_, *rays_, &*neighbors_, duplicates_, *sampler);
    step_queue steps = queue();
    stop_request stop;
    take_steps(
        steps, [&] { return baker.make_set(); },
        [&](const cell_step& step, cell_set& set) {
          return baker.finished(cells_[step.cell], baker.sample_and_finish(cells_[step.cell], set, &stop));
        },
        {.arena = arena, .stop = stop, .workers = lanes}, ended);
  }

  struct told {
    std::map<std::uint32_t, cell_record> records;
    std::vector<std::size_t> in_work;
  };

  // Bakes on so many threads; stop_after cells are told of, the next answer is false.
  told bake(std::size_t lanes, int threads, std::size_t stop_after = cell_total) {
    told out;
    tbb::task_arena arena(threads);
    const auto caller = std::this_thread::get_id();
    run(lanes, arena, [&](std::span<stage_record> ended, std::span<const step_in_work> in_work) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      EXPECT_LE(in_work.size(), lanes);
      for (const stage_record& one : ended)
        EXPECT_TRUE(out.records.emplace(one.cell, one.record).second) << "told twice of " << one.cell;
      out.in_work.push_back(in_work.size());
      return out.records.size() < stop_after;
    });
    return out;
  }

  // The calling thread gets a word in before all cells are done.
  void take_your_time() {
    source_->on_render = [](std::span<const pose>) { std::this_thread::sleep_for(std::chrono::milliseconds(5)); };
  }

  bool in_cell(std::span<const pose> poses, std::uint32_t which) const {
    // Cells touch and are grown: the middle of a face's hemicubes tells them apart no better than all of them.
    float sum = 0.0f;
    for (const pose& p : poses) sum += p.eye.x;
    const float x = sum / static_cast<float>(poses.size());
    return x > cells_[which].min.x && x < cells_[which].max.x;
  }

  const tbb::global_control allowed_{tbb::global_control::max_allowed_parallelism, 8};
  scene::world_geometry geometry_;
  std::optional<ray_scene> rays_;
  std::optional<near_polygons> neighbors_;
  duplicate_classes duplicates_;
  std::optional<traced_source> source_;
  settings how_;
  overrides none_;
  std::vector<view_cell> cells_;
  std::vector<std::uint32_t> wanted_;  // blocks, each of one cell
  std::optional<cell_blocks> blocks_;
  std::optional<stage_plan> plan_;
};

TEST_F(cell_workers, records_are_the_same_with_any_number_of_threads_and_lanes) {
  const told one = bake(1, 1);
  ASSERT_EQ(one.records.size(), cell_total);
  std::set<std::vector<std::uint32_t>> different;
  for (const auto& [which, record] : one.records) {
    EXPECT_TRUE(record.stored && record.bound_met);
    different.insert(record.set);
  }
  EXPECT_GT(different.size(), 6u) << "or a mix-up of cells would go unseen";
  for (const auto& [lanes, threads] : {std::pair{1, 8}, {2, 2}, {8, 8}, {100, 3}})
    EXPECT_EQ(bake(static_cast<std::size_t>(lanes), threads).records, one.records) << lanes << ", " << threads;
}

TEST_F(cell_workers, only_what_is_wanted_is_baked) {
  const auto all = bake(1, 1).records;
  wanted_ = {3, 4, 9};
  const told some = bake(2, 2);
  ASSERT_EQ(some.records.size(), 3u);
  for (const auto& [which, record] : some.records) EXPECT_EQ(record, all.at(which)) << which;
  wanted_.clear();
  EXPECT_TRUE(bake(2, 2).records.empty());
}

TEST_F(cell_workers, several_cells_are_in_work_and_none_at_the_end) {
  const told out = bake(4, 4);
  EXPECT_GE(*std::max_element(out.in_work.begin(), out.in_work.end()), 1u);
  EXPECT_EQ(out.in_work.back(), 0u);
}

TEST_F(cell_workers, finished_cells_are_kept_when_the_user_stops) {
  const auto all = bake(1, 1).records;
  take_your_time();
  for (const std::size_t lanes : {1u, 4u}) {
    const told stopped = bake(lanes, 4, 2);
    EXPECT_GE(stopped.records.size(), 2u);
    EXPECT_LT(stopped.records.size(), lanes == 1 ? 3u : cell_total) << "none is begun after the word";
    for (const auto& [which, record] : stopped.records) EXPECT_EQ(record, all.at(which)) << which;
  }
}

// A step that would take an hour looks at its limit, and ends when the user stops.
TEST_F(cell_workers, a_step_in_work_ends_when_the_user_stops) {
  using std::chrono::milliseconds;
  step_queue steps = queue();
  stop_request stop;
  tbb::task_arena arena(2);
  int finished = 0, reports = 0;
  bool ended_early = false;
  take_steps(
      steps, [] { return cell_set(10, nullptr, 10); },
      [&](const cell_step&, cell_set&) -> cell_record {
        const time_limit limit(0.0, true, &stop);
        try {
          for (int i = 0; i < 3'600'000 && !limit.reached(); ++i) std::this_thread::sleep_for(milliseconds(1));
        } catch (const step_stopped&) {
          ended_early = true;
          throw;
        }
        return {};
      },
      {.arena = arena, .stop = stop, .workers = 1, .pause = milliseconds(2)},
      [&](std::span<stage_record> ended, std::span<const step_in_work> in_work) {
        finished += static_cast<int>(ended.size());
        if (!in_work.empty()) ++reports;
        return reports < 3;
      });
  EXPECT_TRUE(ended_early);
  EXPECT_EQ(finished, 0);
  EXPECT_GE(reports, 3);
  EXPECT_TRUE(stop.asked());
}

TEST_F(cell_workers, an_error_in_a_cell_ends_the_bake_and_spoils_no_other) {
  const auto all = bake(1, 1).records;
  source_->on_render = [&](std::span<const pose> poses) {
    // The others are in the middle of their loops then.
    if (poses.size() == 6 && in_cell(poses, 5)) throw error(error_kind::failed, "test.lost", "cell 5", "lost", "");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  for (const std::size_t lanes : {1u, 2u, 4u}) {
    tbb::task_arena arena(4);
    std::map<std::uint32_t, cell_record> kept;
    try {
      run(lanes, arena, [&](std::span<stage_record> ended, std::span<const step_in_work>) {
        for (const stage_record& one : ended) kept.emplace(one.cell, one.record);
        return true;
      });
      FAIL() << "the error is gone";
    } catch (const error& e) {
      EXPECT_EQ(e.id(), "test.lost");
    }
    EXPECT_GE(kept.size(), lanes == 1 ? 5u : 2u);
    EXPECT_LT(kept.size(), std::size_t{cell_total} - 1) << "no cell is begun after the error";
    EXPECT_FALSE(kept.contains(5));
    for (const auto& [which, record] : kept) EXPECT_EQ(record, all.at(which)) << which;
  }
}

TEST_F(cell_workers, what_the_user_throws_comes_out_and_finished_cells_are_kept) {
  take_your_time();
  for (const std::size_t lanes : {1u, 4u}) {
    tbb::task_arena arena(4);
    std::set<std::uint32_t> kept;
    EXPECT_THROW(run(lanes, arena,
                     [&](std::span<stage_record> ended, std::span<const step_in_work>) -> bool {
                       for (const stage_record& one : ended) kept.insert(one.cell);
                       throw std::runtime_error("enough");
                     }),
                 std::runtime_error);
    EXPECT_GE(kept.size(), 1u);
    EXPECT_LT(kept.size(), lanes == 1 ? 2u : cell_total);
  }
}

TEST_F(cell_workers, a_thread_that_waits_inside_of_a_cell_begins_no_other) {
  // What a thread notes before a loop is there after it: nobody baked another cell on top.
  static thread_local std::span<const pose> mine;
  std::atomic<int> spoiled = 0, loops = 0;
  source_->on_render = [&](std::span<const pose> poses) {
    mine = poses;
    tbb::parallel_for(0, 16, [](int i) { std::this_thread::sleep_for(std::chrono::microseconds(50 << (i % 5))); });
    spoiled += mine.data() == poses.data() ? 0 : 1;
    ++loops;
  };
  how_.max_pixel_error = 0.5;
  // More lanes than threads, so that some wait to be begun; a matter of chance, so often.
  for (int i = 0; i < 8; ++i) EXPECT_EQ(bake(cell_total, 8).records.size(), cell_total);
  EXPECT_GT(loops, 14);
  EXPECT_EQ(spoiled, 0);
}

TEST_F(cell_workers, a_disk_that_is_slow_holds_the_lanes_up) {
  how_.samples = 6;
  how_.max_pixel_error = 0.0;
  wanted_.clear();
  cells_.assign(150, cells_.front());
  for (std::uint32_t i = 0; i < cells_.size(); ++i) wanted_.push_back(i);
  blocks_.emplace(cells_, how_.margin);
  plan_.emplace(*blocks_, false);
  std::atomic<std::size_t> begun = 0;
  source_->on_render = [&](std::span<const pose>) { ++begun; };  // one round, so one call for each cell
  tbb::task_arena arena(2);
  std::size_t ended = 0;
  const auto slow = [&](std::span<stage_record> records, std::span<const step_in_work>) {
    const bool first = ended == 0;
    ended += records.size();
    if (!first) return true;
    for (int i = 0; i < 2000 && begun < 60; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // enough for some more
    EXPECT_LE(begun, records.size() + 64u + 2u);
    return true;
  };
  run(2, arena, slow, false);
  EXPECT_EQ(ended, wanted_.size());
  EXPECT_EQ(begun, wanted_.size());
}

TEST(worker_count, follows_threads_and_memory) {
  EXPECT_EQ(worker_count(8, 1000), 8u);
  EXPECT_EQ(worker_count(1, 1000), 1u);
  EXPECT_EQ(worker_count(64, 8 * 7'928'519), 16u) << "eight million polygons";
  EXPECT_EQ(worker_count(64, std::size_t{2} << 30), 1u);
  EXPECT_EQ(worker_count(4, 0), 4u);
}

}  // namespace
}  // namespace sightcell::bake
