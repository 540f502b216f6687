// What a bake reports while cells are in work: phases, time left before the first cell has ended, and slow cells.
#include "job/progress_tracker.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "job/cell_workers.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/shards.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/two_rooms.h"

namespace sightcell::bake {
namespace {

using std::chrono::milliseconds;

// Four cells that share nothing, and a clock that the test sets.
class tracked_bake : public testing::Test {
 protected:
  static constexpr std::uint32_t cell_total = 4;

  tracked_bake() {
    for (std::uint32_t i = 0; i < cell_total; ++i) {
      const float x = 10.0f * static_cast<float>(i);
      cells_.push_back({{x, 0, -2}, {x + 2, 1, 4}, "", 1000u + i});
    }
    blocks_.emplace(cells_, 0.25f);
    plan_.emplace(*blocks_, false);
    done_.emplace(folder_ / "test.bake", "test", true);
    events_.on_phase = [this](bake_phase phase) { phases_.push_back(phase); };
    events_.on_progress = [this](const progress& now) {
      reports_.push_back(now);
      bounded_.emplace_back(now.bounded.begin(), now.bounded.end());
      reports_.back().bounded = {};  // valid during the call
      return !cancel_;
    };
    events_.on_stopping = [this](const progress& now) { stopping_.push_back(now); };
  }
  progress_tracker tracker() {
    return progress_tracker(
        {.polygon_count = 100, .cells = cells_, .total = cell_total, .now = [this] { return now_; }}, *plan_, events_);
  }
  void wait(int seconds) { now_ += std::chrono::seconds(seconds); }
  step_in_work begun(std::uint32_t cell, int seconds_ago) const {
    return {cell, now_ - std::chrono::seconds(seconds_ago)};
  }
  bool end(progress_tracker& tracker, std::uint32_t cell, std::span<const step_in_work> in_work = {},
           double seconds = 0.0) {
    const stage_record record{cell, cell_stage::finished, {}, seconds};
    return tracker.close({&record, 1}, in_work, *done_);
  }

  test::fresh_folder folder_;
  std::vector<view_cell> cells_;
  std::optional<cell_blocks> blocks_;
  std::optional<stage_plan> plan_;
  std::optional<checkpoint> done_;
  work_clock::time_point now_{std::chrono::hours(1)};
  callbacks events_;
  std::vector<bake_phase> phases_;
  std::vector<progress> reports_, stopping_;
  std::vector<std::vector<bounded_cell>> bounded_;  // of each report
  bool cancel_ = false;
};

TEST_F(tracked_bake, times_are_those_of_cells_that_this_run_baked) {
  auto tracked = tracker();
  EXPECT_EQ(tracked.times().cells, 0u);
  tracked.resume(0, cell_stage::finished, {});
  tracked.open();
  const stage_record sampled{3, cell_stage::sampled, {}, 7.0};
  tracked.close({&sampled, 1}, {}, *done_);
  EXPECT_EQ(tracked.times().cells, 0u) << "cell 3 is not finished";
  end(tracked, 1, {}, 1.0);
  end(tracked, 2, {}, 2.0);
  end(tracked, 3, {}, 3.0);
  const cell_times times = tracked.times();
  EXPECT_EQ(times.cells, 3u);
  EXPECT_EQ(times.median, 2.0);
  EXPECT_EQ(times.percentile_99, 10.0);
  EXPECT_EQ(times.longest, 10.0) << "the steps of a cell add up";
  EXPECT_EQ(times.center, (std::array<float, 3>{31.0f, 0.5f, 1.0f}));
}

TEST_F(tracked_bake, each_cell_is_reported_once_with_its_bound) {
  auto tracked = tracker();
  tracked.resume(2, cell_stage::finished, {.rays = 10, .misses = 1, .upper_bound = 0.25, .polygons = 7});
  tracked.resume(0, cell_stage::finished, {.stored = false});
  tracked.open();
  const stage_record sampled{1, cell_stage::sampled, {}, 7.0};
  tracked.close({&sampled, 1}, {}, *done_);
  end(tracked, 1, {}, 1.0);
  tracked.close({}, {}, *done_);
  ASSERT_EQ(bounded_.size(), 4u);
  ASSERT_EQ(bounded_[0].size(), 1u) << "of the earlier run, without the cell that is not stored";
  EXPECT_EQ(bounded_[0][0].cell, 2u);
  EXPECT_EQ(bounded_[0][0].min, (std::array<float, 3>{20, 0, -2}));
  EXPECT_EQ(bounded_[0][0].max, (std::array<float, 3>{22, 1, 4}));
  EXPECT_EQ(bounded_[0][0].polygons, 7u);
  EXPECT_EQ(bounded_[0][0].bound, 0.25);
  EXPECT_LT(bounded_[0][0].seconds, 0.0) << "an earlier run began the cell";
  EXPECT_TRUE(bounded_[1].empty()) << "a sampled cell has no bound";
  ASSERT_EQ(bounded_[2].size(), 1u);
  EXPECT_EQ(bounded_[2][0].cell, 1u);
  EXPECT_EQ(bounded_[2][0].bound, 1.0) << "no ray was cast";
  EXPECT_EQ(bounded_[2][0].seconds, 8.0) << "the steps of a cell add up";
  EXPECT_TRUE(bounded_[3].empty());
}

TEST_F(tracked_bake, time_left_is_the_estimate_until_a_step_has_ended) {
  auto tracked = tracker();
  tracked.expect(40.0);
  wait(100);  // of the estimate itself
  tracked.open();
  EXPECT_EQ(reports_.back().seconds_left, 40.0);
  wait(5);
  const std::vector<step_in_work> first{begun(0, 5)};
  tracked.close({}, first, *done_);
  EXPECT_EQ(reports_.back().seconds_left, 35.0);
  EXPECT_EQ(reports_.back().cells_per_second, 0.0) << "not known";
  wait(60);
  tracked.close({}, first, *done_);
  EXPECT_EQ(reports_.back().seconds_left, 30.0) << "of the three cells that have not begun";
  wait(15);
  end(tracked, 0);
  EXPECT_DOUBLE_EQ(reports_.back().cells_per_second, 1.0 / 80.0);
  EXPECT_DOUBLE_EQ(reports_.back().seconds_left, 240.0) << "the rate counts now";
}

TEST_F(tracked_bake, time_left_is_unknown_without_an_estimate) {
  auto tracked = tracker();
  tracked.open();
  EXPECT_EQ(reports_.back().seconds_left, 0.0);
}

TEST_F(tracked_bake, the_cell_longest_in_work_is_named_from_ten_seconds_on) {
  auto tracked = tracker();
  tracked.open();
  EXPECT_FALSE(reports_.back().slow);
  std::vector<step_in_work> in_work{begun(3, 2), begun(1, 9), begun(2, 8)};
  tracked.close({}, in_work, *done_);
  EXPECT_FALSE(reports_.back().slow);
  EXPECT_EQ(reports_.back().cells_in_work, 3u);
  wait(25);
  end(tracked, 0, in_work);
  ASSERT_TRUE(reports_.back().slow);
  EXPECT_EQ(reports_.back().slow->cell, 1u);
  EXPECT_EQ(reports_.back().slow->center, (std::array<float, 3>{11.0f, 0.5f, 1.0f}));
  EXPECT_EQ(reports_.back().slow->seconds, 34.0);
  in_work = {begun(3, 11)};
  end(tracked, 1, in_work);
  EXPECT_EQ(reports_.back().slow->cell, 3u) << "the next one, when that has ended";
  end(tracked, 3);
  EXPECT_FALSE(reports_.back().slow);
}

TEST_F(tracked_bake, a_canceled_bake_reports_what_it_waits_for) {
  auto tracked = tracker();
  tracked.open();
  cancel_ = true;
  const std::vector<step_in_work> in_work{begun(2, 1), begun(1, 3)};
  EXPECT_FALSE(tracked.close({}, in_work, *done_));
  EXPECT_TRUE(stopping_.empty());
  const std::size_t reports = reports_.size();
  wait(1);
  EXPECT_FALSE(tracked.close({}, in_work, *done_));
  ASSERT_EQ(stopping_.size(), 1u);
  EXPECT_EQ(stopping_.back().cells_in_work, 2u);
  ASSERT_TRUE(stopping_.back().slow) << "however short";
  EXPECT_EQ(stopping_.back().slow->cell, 1u);
  EXPECT_EQ(stopping_.back().slow->seconds, 4.0);
  EXPECT_FALSE(end(tracked, 1));
  EXPECT_EQ(stopping_.size(), 1u) << "nothing is in work";
  EXPECT_EQ(reports_.size(), reports) << "no report after a cancel";
  EXPECT_TRUE(tracked.have().has(1, cell_stage::finished)) << "and yet the cell is kept";
}

TEST_F(tracked_bake, a_callback_that_throws_is_the_last_one) {
  auto tracked = tracker();
  events_.on_progress = [](const progress&) -> bool { throw std::runtime_error("enough"); };
  const std::vector<step_in_work> in_work{begun(2, 1)};
  EXPECT_THROW(tracked.close({}, in_work, *done_), std::runtime_error);
  EXPECT_FALSE(tracked.close({}, in_work, *done_));
  EXPECT_TRUE(stopping_.empty());
}

TEST_F(tracked_bake, a_phase_is_reported_once_and_is_in_the_progress) {
  auto tracked = tracker();
  tracked.open();
  EXPECT_EQ(reports_.back().phase, bake_phase::estimating);
  tracked.begin(bake_phase::baking_cells);
  tracked.begin(bake_phase::baking_cells);
  end(tracked, 0);
  EXPECT_EQ(reports_.back().phase, bake_phase::baking_cells);
  tracked.begin(bake_phase::checking_neighbors);
  EXPECT_EQ(phases_, (std::vector{bake_phase::baking_cells, bake_phase::checking_neighbors}));
}

TEST_F(tracked_bake, the_neighbor_check_is_the_phase_once_all_cells_have_a_bound) {
  for (const int last_phase : {1, 2}) {
    phases_.clear();
    progress_tracker tracked({.polygon_count = 100, .cells = cells_, .total = cell_total, .last_phase = last_phase},
                             *plan_, events_);
    tracked.open();
    tracked.begin(bake_phase::baking_cells);
    end(tracked, 0);
    for (std::uint32_t cell = 1; cell < cell_total; ++cell) {
      EXPECT_EQ(phases_, (std::vector{bake_phase::baking_cells}));
      const stage_record bounded{cell, cell_stage::bounded, {}, 1.0};
      tracked.close({&bounded, 1}, {}, *done_);
    }
    auto expected = std::vector{bake_phase::baking_cells};
    if (last_phase == 2) expected.push_back(bake_phase::checking_neighbors);
    EXPECT_EQ(phases_, expected) << "phase 1 alone has no check";
    EXPECT_EQ(reports_.back().phase, expected.back());
  }
}

// One cell that ends when two reports have been made while it was in work.
TEST_F(tracked_bake, a_cell_that_takes_long_does_not_silence_progress) {
  for (const std::size_t workers : {1u, 2u}) {
    auto tracked = tracker();
    tracked.open();
    reports_.clear();
    std::atomic<int> reports_in_work = 0;
    std::vector<std::uint32_t> blocks(cell_total);
    std::iota(blocks.begin(), blocks.end(), 0u);
    step_queue queue = step_queue::phase_1(*plan_, stage_table(cell_total), blocks);
    tbb::task_arena arena(2);
    stop_request stop;
    const auto caller = std::this_thread::get_id();
    take_steps(
        queue, [] { return cell_set(10, nullptr, 10); },
        [&](const cell_step& step, cell_set&) {
          // The limit is for a bake that reports nothing: the test fails then, and ends.
          for (int i = 0; step.cell == 0 && i < 30'000 && reports_in_work < 2; ++i)
            std::this_thread::sleep_for(milliseconds(1));
          return cell_record();
        },
        {.arena = arena, .stop = stop, .workers = workers, .pause = milliseconds(1)},
        [&](std::span<stage_record> ended, std::span<const step_in_work> in_work) {
          EXPECT_EQ(std::this_thread::get_id(), caller);
          const bool proceed = tracked.close(ended, in_work, *done_);
          for (const step_in_work& one : in_work) reports_in_work += ended.empty() && one.cell == 0 ? 1 : 0;
          return proceed;
        });
    EXPECT_GE(reports_in_work, 2) << workers;
    EXPECT_EQ(reports_.back().cells_checked, cell_total);
    EXPECT_EQ(reports_.back().cells_in_work, 0u);
  }
}

// Whole bakes of two rooms.
class phases_of_a_bake : public testing::Test {
 protected:
  void SetUp() override {
    how_.cells_grid = {-6.0f, 0.0f, -6.0f, 6.0f, 3.0f, 6.0f};
    how_.cell_size = 6.0f;
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 0.1;
    how_.source = "cpu";
    events_.on_phase = [this](bake_phase phase) {
      EXPECT_EQ(std::this_thread::get_id(), caller_);
      phases_.push_back(phase);
    };
    events_.on_progress = [this](const progress& now) {
      EXPECT_EQ(now.phase, phases_.back());
      return true;
    };
  }
  std::vector<bake_phase> phases(bool fresh = true) {
    phases_.clear();
    EXPECT_EQ(bake(scene_, how_, folder_ / "rooms.pvs", fresh, events_).result, outcome::done);
    return phases_;
  }

  const std::thread::id caller_ = std::this_thread::get_id();
  test::fresh_folder folder_;
  scene::scene scene_ = test::two_rooms();
  settings how_;
  callbacks events_;
  std::vector<bake_phase> phases_;
};

using phase_list = std::vector<bake_phase>;
using enum bake_phase;

TEST_F(phases_of_a_bake, come_in_their_order) {
  how_.file.importance = true;
  EXPECT_EQ(phases(), (phase_list{loading, finding_cells, preparing_hemicubes, estimating, baking_cells,
                                  checking_neighbors, writing_file, measuring_importance}));
}

TEST_F(phases_of_a_bake, with_nothing_to_do_are_left_out) {
  how_.max_pixel_error = 0.0;
  EXPECT_EQ(phases(), (phase_list{loading, finding_cells, preparing_hemicubes, estimating, baking_cells, writing_file}))
      << "cells share nothing";
}

TEST_F(phases_of_a_bake, include_the_preparation_of_a_sampler) {
  how_.sampler = "agvs";
  EXPECT_EQ(phases(), (phase_list{loading, finding_cells, preparing_hemicubes, estimating, preparing_sampler,
                                  baking_cells, checking_neighbors, writing_file}));
}

TEST_F(phases_of_a_bake, are_the_same_with_a_time_budget) {
  how_.time_budget = 1e6;
  EXPECT_EQ(phases(), (phase_list{loading, finding_cells, preparing_hemicubes, estimating, baking_cells,
                                  checking_neighbors, writing_file}));
}

TEST_F(phases_of_a_bake, of_shards_are_parts_of_those) {
  for (const std::uint32_t phase : {1u, 2u}) {
    phases_.clear();
    (void)bake_shard(scene_, how_, folder_ / "s.pvs", {0, 1, phase}, true, events_);
    EXPECT_EQ(phases_, (phase_list{loading, finding_cells, preparing_hemicubes, estimating,
                                   phase == 1 ? baking_cells : checking_neighbors, writing_file}));
  }
  phases_.clear();
  (void)merge(find_shard_files(folder_ / "s.pvs"), folder_ / "s.pvs", events_);
  EXPECT_EQ(phases_, phase_list{writing_file});
}

}  // namespace
}  // namespace sightcell::bake
