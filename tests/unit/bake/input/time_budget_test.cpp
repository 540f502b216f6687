// Bakes that spend a time budget: whatever the clock says, sets only grow, bounds only fall, and what is printed holds.
// No test asks how long something took.
#include "sightcell/base/time_budget.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "errors/error_id.h"
#include "job/bake_context.h"
#include "job/cell_bake.h"
#include "job/phases.h"
#include "job/timed_progress.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/bake/stored_file.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

namespace fs = std::filesystem;
using polygons = std::vector<std::uint32_t>;

// What a file says, by the lowest corner of its cells.
struct file_cell {
  polygons set;
  format::certificate_record proof;
};
using file_cells = std::map<std::array<float, 3>, file_cell>;

// A room with pillars, and cells that see different ones of them; one lies in a pillar.
class time_budget_bake : public testing::Test {
 protected:
  void SetUp() override {
    test::tiny_scene tiny;
    tiny.room_with_pillars();
    tiny.closed_box({1.7f, -3, 1.7f}, {4.3f, 2.9f, 4.3f});
    scene_ = tiny.finished();
    how_.cells_grid = {-4.0f, 0.0f, -4.0f, 4.0f, 1.0f, 4.0f};
    how_.cell_size = 2.0f;
    how_.source = "cpu";
    how_.resolution = 16;
    how_.samples = 6;
    how_.max_pixel_error = 1e-3;
    how_.file.profile = slack_profile::exact;
    how_.time_budget = 1e6;  // as good as none: passes end when the bounds are met
  }

  fs::path output() const { return folder_ / "room.pvs"; }
  fs::path records() const { return folder_ / "room.pvs.bake"; }
  summary baked(const callbacks& events = {}) { return bake(scene_, how_, output(), false, events); }
  // Until a pass to a smaller target than this begins.
  summary baked_to(double target) {
    callbacks events;
    events.on_progress = [=](const progress& now) { return now.target >= target; };
    return baked(events);
  }
  std::map<std::uint32_t, cell_record> kept() const {
    std::map<std::uint32_t, cell_record> all;
    const checkpoint file = checkpoint::open_to_read(records());
    file.list([&](std::uint32_t cell, cell_stage stage) {
      EXPECT_EQ(stage, cell_stage::bounded);
      all[cell] = {};
    });
    for (auto& [cell, record] : all) record = *file.load(cell, cell_stage::bounded);
    return all;
  }
  static file_cells cells_of(const std::vector<std::byte>& bytes, bool repeatable = false) {
    file_cells all;
    test::stored_file stored(bytes);
    const format::reader& file = stored.reader();
    EXPECT_EQ(file.facts().repeatable, repeatable);
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      format::box where;
      EXPECT_EQ(file.cell_box(cell, where), format::status::ok);
      file_cell& one = all[where.min];
      one.set = stored.set(cell);
      EXPECT_EQ(file.certificate(cell, one.proof), format::status::ok);
      EXPECT_LE(one.proof.upper_bound, static_cast<double>(file.facts().max_pixel_error));
    }
    return all;
  }
  file_cells written() const { return cells_of(test::file_bytes(output())); }
  static void expect_no_worse(const file_cells& later, const file_cells& before) {
    for (const auto& [place, one] : before) {
      const auto found = later.find(place);
      ASSERT_NE(found, later.end()) << "a cell has gone";
      EXPECT_TRUE(std::includes(found->second.set.begin(), found->second.set.end(), one.set.begin(), one.set.end()));
      EXPECT_LE(found->second.proof.upper_bound, one.proof.upper_bound);
    }
  }

  test::fresh_folder folder_;
  scene::scene scene_;
  settings how_;
};

TEST_F(time_budget_bake, goes_to_falling_targets_and_ends_when_all_are_met) {
  how_.threads = 1;
  std::vector<double> targets;
  int told_when_all_were_met = 0;
  callbacks events;
  events.on_progress = [&](const progress& now) {
    if (targets.empty() || targets.back() != now.target) targets.push_back(now.target);
    told_when_all_were_met += now.cells_checked == now.cells_total;
    return true;
  };
  const summary sum = baked(events);
  EXPECT_EQ(targets, (std::vector<double>{1e-2, 2.5e-3, 1e-3}));
  EXPECT_GT(told_when_all_were_met, 15) << "then what neighbors see is tried once more";
  EXPECT_EQ(sum.result, outcome::done);
  EXPECT_EQ(sum.cells, 15u);
  EXPECT_EQ(sum.cells_left_out, 1u) << "in the pillar";
  EXPECT_EQ(sum.cells_over_bound + sum.cells_out_of_time + sum.cells_unreached, 0u);
  EXPECT_LE(sum.max_upper_bound, 1e-3);
  EXPECT_FALSE(fs::exists(records()));
  for (const auto& [place, one] : written()) {
    EXPECT_LE(one.proof.upper_bound, 1e-3);
    // Batch j has 0.05 / 2^j of the risk, over all passes; the file says it to 24 bits.
    const double batch = std::log2(0.05 / (1.0 - one.proof.confidence));
    EXPECT_NEAR(batch, std::round(batch), 0.01);
  }
  verify_settings look;
  look.rays = 400'000;
  EXPECT_LE(verify(scene_, test::file_bytes(output()), "room.pvs", look, {}).pixel_error, 1e-3);
}

TEST_F(time_budget_bake, one_target_is_enough_where_it_is_large) {
  how_.max_pixel_error = 0.05;
  EXPECT_EQ(baked_to(0.05).result, outcome::done);
}

TEST_F(time_budget_bake, stopped_it_leaves_a_file_and_goes_on_from_its_records) {
  EXPECT_EQ(baked_to(2.5e-3).result, outcome::cancelled);
  const auto first = kept();
  const file_cells first_file = written();
  ASSERT_EQ(first_file.size(), 15u);
  how_.time_budget = 2e6;  // another one goes on from there too
  const summary sum = baked();
  EXPECT_EQ(sum.result, outcome::done);
  EXPECT_EQ(sum.cells_resumed, 16u);
  expect_no_worse(written(), first_file);
  how_.time_budget = 0.0;
  EXPECT_EQ(bake(scene_, how_, folder_ / "other.pvs", false, {}).result, outcome::done);
}

TEST_F(time_budget_bake, a_cell_counts_its_batches_and_keeps_its_least_bound) {
  how_.max_pixel_error = 1e-4;
  (void)baked_to(2.5e-3);
  const auto before = kept();
  (void)baked_to(6.25e-4);
  const auto after = kept();
  ASSERT_EQ(before.size(), 16u);
  std::uint32_t more = 0;
  for (const auto& [cell, was] : before) {
    const cell_record& is = after.at(cell);
    EXPECT_EQ(is.stored, was.stored);
    EXPECT_TRUE(std::includes(is.set.begin(), is.set.end(), was.set.begin(), was.set.end()));
    EXPECT_LE(is.upper_bound, was.upper_bound);
    EXPECT_GE(is.batches, was.batches);
    EXPECT_GE(is.samples, was.samples);
    if (!is.stored || is.batches == was.batches) continue;
    ++more;
    EXPECT_LE(is.upper_bound, 6.25e-4);
    EXPECT_GE(is.confidence, 1.0 - 0.05 / std::ldexp(1.0, static_cast<int>(was.batches) + 1))
        << "the bound is of a later batch, and all before it have had their shares";
  }
  EXPECT_GT(more, 10u);
}

TEST_F(time_budget_bake, a_turn_that_proves_less_takes_nothing_back) {
  tbb::task_arena arena;
  const bake_context context(scene_, how_, {}, {}, arena, {});
  const cell_baker baker = baker_of(context);
  const view_cell& cell = context.cells->list.cells.front();
  cell_set set = baker.make_set();
  const time_limit none(0.0, false), over(1e-9, false);
  const cell_record first = baker.improve(cell, nullptr, {}, {1e-3, 2'000'000, &none}, set);
  EXPECT_LE(first.upper_bound, 1e-3);
  const cell_record again = baker.improve(cell, &first, {}, {1e-7, 1, &none}, set);
  EXPECT_EQ(again.batches, first.batches + 1) << "one that had few rays";
  EXPECT_EQ(again.upper_bound, first.upper_bound);
  EXPECT_EQ(again.rays, first.rays);
  EXPECT_EQ(again.confidence, first.confidence);
  EXPECT_TRUE(again.bound_met);
  EXPECT_TRUE(std::includes(again.set.begin(), again.set.end(), first.set.begin(), first.set.end()));
  EXPECT_EQ(baker.improve(cell, &again, {}, {1e-7, 1, &over}, set), again) << "without time nothing is done";
  EXPECT_EQ(baker.improve(cell, nullptr, {}, {1e-2, 1, &over}, set), cell_record());
}

TEST_F(time_budget_bake, a_cell_whose_turn_had_no_time_begins_anew) {
  EXPECT_EQ(baked_to(2.5e-3).result, outcome::cancelled);
  {
    checkpoint edit(records(), checkpoint::open_to_read(records()).key(), false);
    std::vector<stage_record> blank;
    for (std::uint32_t cell = 0; cell < 16; ++cell) blank.push_back({cell, cell_stage::bounded, {}});
    edit.store(blank);
  }
  const summary sum = baked();
  EXPECT_EQ(sum.result, outcome::done);
  EXPECT_EQ(sum.cells, 15u);
  EXPECT_EQ(sum.cells_left_out, 1u) << "nobody had looked whether it has a free place";
}

TEST_F(time_budget_bake, files_only_get_better) {
  how_.time_budget = 2.0;  // the first after a tenth of it
  how_.max_pixel_error = 1e-7;
  std::vector<std::vector<std::byte>> files;
  callbacks events;
  events.on_progress = [&](const progress&) {
    std::vector<std::byte> now = test::file_bytes(output());
    if (!now.empty() && (files.empty() || files.back() != now)) files.push_back(std::move(now));
    return true;
  };
  const summary sum = baked(events);
  EXPECT_EQ(sum.result, outcome::bound_not_met);
  EXPECT_EQ(sum.cells_over_bound, sum.cells);
  EXPECT_EQ(sum.cells_out_of_time, sum.cells);
  EXPECT_FALSE(fs::exists(records())) << "its time is spent";
  ASSERT_FALSE(files.empty()) << "none before the end";
  files.push_back(test::file_bytes(output()));
  for (std::size_t i = 1; i < files.size(); ++i) expect_no_worse(cells_of(files[i]), cells_of(files[i - 1]));
}

TEST_F(time_budget_bake, cells_that_had_no_turn_are_not_in_the_file) {
  how_.time_budget = 3.0;
  how_.threads = 1;
  time_budget clock(how_.time_budget, 0.0);
  std::string warnings;
  callbacks events;
  events.on_progress = [&](const progress& now) {
    while (now.cells_done >= 4 && !clock.over()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return true;
  };
  events.on_message = [&](severity how_bad, const std::string& text) {
    if (how_bad == severity::warning) warnings += text + "\n";
  };
  const summary sum = baked(events);
  EXPECT_EQ(sum.result, outcome::bound_not_met);
  EXPECT_EQ(sum.cells + sum.cells_left_out + sum.cells_unreached, 16u);
  EXPECT_GE(sum.cells_unreached, 11u);
  EXPECT_NE(warnings.find("of 16 cells have no bound yet and are left out"), std::string::npos) << warnings;
  for (const auto& [place, one] : written()) EXPECT_LT(one.proof.upper_bound, 1.0);
}

TEST_F(time_budget_bake, too_little_time_for_any_cell_is_an_error_that_loses_nothing) {
  EXPECT_EQ(baked_to(2.5e-3).result, outcome::cancelled);
  fs::remove(output());
  how_.time_spent = 1e7;  // on loading
  EXPECT_EQ(baked().result, outcome::bound_not_met) << "what was found before is a file all the same";
  EXPECT_EQ(written().size(), 15u);
  EXPECT_EQ(test::error_id([&] { (void)baked(); }), "bake.time-budget");
  EXPECT_TRUE(fs::exists(records()));
  how_.time_spent = 0.0;
  EXPECT_EQ(baked().result, outcome::done) << "records of turns without time are no records";
}

TEST_F(time_budget_bake, other_clocks_are_told_of_too) {
  how_.time_budget = 0.0;
  (void)baked();
  (void)cells_of(test::file_bytes(output()), true);
  how_.seconds_per_cell = 100.0;
  (void)baked();
  (void)cells_of(test::file_bytes(output()), false);
}

TEST_F(time_budget_bake, rings_and_levels_of_detail_join_in_every_file) {
  how_.safety_ring = safety_ring::vertex;
  (void)baked_to(2.5e-3);
  const file_cells first = written();
  const summary sum = baked();
  EXPECT_GT(sum.unseen_per_cell, 0.0);
  expect_no_worse(written(), first);
}

cell_summary with_bound(double bound, bool stored = true) {
  cell_summary one;
  one.stored = stored;
  one.upper_bound = bound;
  return one;
}

TEST(timed_progress, says_whose_turn_it_is) {
  const time_budget clock(1e6, 0.0);
  const callbacks silent;
  const std::vector<view_cell> cells(6);
  timed_progress tracker(100, cells, 1e-3, clock, silent);
  EXPECT_EQ(tracker.above(1e-2), (polygons{0, 1, 2, 3, 4, 5})) << "in their order where nothing is known";
  tracker.resume(0, with_bound(2e-3));
  tracker.resume(1, with_bound(1.0, false));
  tracker.resume(2, with_bound(9e-3));
  tracker.resume(3, with_bound(1e-3));
  tracker.resume(5, with_bound(2e-3));
  EXPECT_EQ(tracker.above(1e-2), (polygons{4})) << "of which nothing is known";
  EXPECT_EQ(tracker.above(1e-3), (polygons{4, 2, 0, 5})) << "the largest bound first";
  EXPECT_EQ(tracker.known(), (polygons{0, 1, 2, 3, 5}));
  EXPECT_EQ(tracker.bounded(), 4u);
  EXPECT_EQ(tracker.unreached(), 1u);
  EXPECT_EQ(tracker.resumed(), 5u);
}

TEST(timed_progress, tells_cells_without_rays_from_cells_without_time) {
  const fs::path path = fs::path(testing::TempDir()) / "sightcell_timed_ledger.bake";
  checkpoint file(path, "test", true);
  const callbacks silent;
  const auto turn = [&](timed_progress& tracker, std::uint32_t cell, double target) {
    (void)tracker.open(target);
    stage_record ended{cell, cell_stage::bounded, {}};
    ended.record.upper_bound = 5e-3;
    return tracker.close({&ended, 1}, {}, file);
  };
  const time_budget clock(1e6, 0.0), over(1.0, 2.0);
  const std::vector<view_cell> cells(2);
  timed_progress in_time(100, cells, 1e-3, clock, silent), late(100, cells, 1e-3, over, silent);
  EXPECT_TRUE(turn(in_time, 0, 1e-2));
  EXPECT_EQ(in_time.out_of_rays(), 0u) << "it will have another turn";
  EXPECT_TRUE(turn(in_time, 0, 1e-3));
  EXPECT_EQ(in_time.out_of_rays(), 1u);
  EXPECT_FALSE(turn(late, 0, 1e-3));
  EXPECT_EQ(late.out_of_rays(), 0u);
  file.remove();
}

TEST(time_budget, keeps_back_what_it_is_told_to) {
  time_budget clock(100.0, 40.0);
  EXPECT_FALSE(clock.over());
  EXPECT_FALSE(clock.limit().reached());
  clock.keep_back(60.0);
  EXPECT_TRUE(clock.over());
  EXPECT_TRUE(clock.limit().reached());
}

}  // namespace
}  // namespace sightcell::bake
