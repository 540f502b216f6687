#include "progress_text.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace sightcell::cli {
namespace {

using bake::bake_phase;
using bake::progress;

constexpr std::size_t widths[] = {40, 80, 120};

progress with_slow_cell() {
  progress now;
  now.cells_done = 1;
  now.cells_total = 60;
  now.cells_in_work = 2;
  now.seconds = 35.0;
  now.seconds_left = 18.0 * 60.0;
  now.cells_per_second = 0.05;
  now.pixel_error = 1.2e-6;
  now.worst_bound = 9.9e-5;
  now.visible_percent = 3.21;
  now.slow = bake::slow_cell{2, {-122.4f, 7.0f, -89.6f}, 34.2};
  return now;
}

progress without_slow_cell() {
  progress now = with_slow_cell();
  now.slow.reset();
  return now;
}

// Numbers as long as they get.
progress large() {
  progress now = with_slow_cell();
  now.cells_done = 4'000'000'000u;
  now.cells_total = now.cells_in_work = now.cells_checked = 4'294'967'295u;
  now.seconds_left = 1e30;
  now.cells_per_second = 1e9;
  now.target = 1e-300;
  now.slow = bake::slow_cell{4'294'967'295u, {-1e30f, 1e30f, -1e30f}, 1e30};
  return now;
}

TEST(progress_text, names_the_slow_cell_at_80_columns) {
  EXPECT_EQ(progress_text(with_slow_cell(), 80),
            "baking cells: 1 of 60, 18 min left, cell 2 (-122, 7, -90) m for 34 s");
}

TEST(progress_text, leaves_out_what_matters_least) {
  EXPECT_EQ(progress_text(with_slow_cell(), 40), "baking cells: 1 of 60, 18 min left");
  EXPECT_EQ(progress_text(with_slow_cell(), 60), "baking cells: 1 of 60, 18 min left, cell 2 for 34 s");
  EXPECT_EQ(progress_text(with_slow_cell(), 120),
            "baking cells: 1 of 60, 3.0 cells/min, 18 min left, cell 2 (-122, 7, -90) m for 34 s, error 1.2e-06, "
            "worst bound 9.9e-05");
  EXPECT_EQ(progress_text(with_slow_cell(), 30), "baking cells: 1 of 60");
  EXPECT_EQ(progress_text(with_slow_cell(), 10), "baking cel");
  EXPECT_EQ(progress_text(with_slow_cell(), 0), "");
}

TEST(progress_text, has_everything_at_120_columns) {
  EXPECT_EQ(progress_text(without_slow_cell(), 120),
            "baking cells: 1 of 60, 3.0 cells/min, 18 min left, error 1.2e-06, worst bound 9.9e-05, 3.21 % visible");
}

TEST(progress_text, knows_the_time_left_before_the_rate) {
  progress now;
  now.cells_total = 60;
  EXPECT_EQ(progress_text(now, 120), "baking cells: 0 of 60") << "neither is known";
  now.seconds_left = 71.0;
  EXPECT_EQ(progress_text(now, 120), "baking cells: 0 of 60, 71 s left");
  now.seconds_left = 0.2;
  EXPECT_EQ(progress_text(now, 120), "baking cells: 0 of 60, 1 s left");
}

TEST(progress_text, of_each_phase) {
  progress now = without_slow_cell();
  now.cells_checked = 7;
  now.prepared = 0.4;
  now.importance = 0.42;
  const auto text = [&](bake_phase phase) {
    now.phase = phase;
    return progress_text(now, 40);
  };
  EXPECT_EQ(text(bake_phase::loading), "loading");
  EXPECT_EQ(text(bake_phase::finding_cells), "finding cells");
  EXPECT_EQ(text(bake_phase::preparing_hemicubes), "preparing hemicubes");
  EXPECT_EQ(text(bake_phase::estimating), "estimating the time");
  EXPECT_EQ(text(bake_phase::merging_cells), "merging cells: 40 %, 18 min left");
  EXPECT_TRUE(is_counted(bake_phase::merging_cells));  // a log has these lines, and not only seconds
  EXPECT_EQ(text(bake_phase::preparing_sampler), "preparing the sampler: 40 %, 18 min left");
  EXPECT_EQ(text(bake_phase::baking_cells), "baking cells: 1 of 60, 18 min left");
  EXPECT_EQ(text(bake_phase::checking_neighbors), "neighbor check: 7 of 60, 18 min left");
  EXPECT_EQ(text(bake_phase::writing_file), "writing the file");
  EXPECT_EQ(text(bake_phase::measuring_importance), "importance of polygons: 42 %");
}

TEST(progress_text, of_a_time_budget_has_the_bound_that_cells_are_brought_to) {
  progress now = without_slow_cell();
  now.cells_done = 57;
  now.cells_checked = 12;
  now.target = 2.5e-3;
  EXPECT_EQ(progress_text(now, 80), "baking cells: 57 of 60, 12 finished, now to bound 2.5e-03, 18 min left");
}

TEST(progress_text, at_the_end_has_the_time_that_it_took) {
  progress now = without_slow_cell();
  now.cells_done = now.cells_checked = 60;
  now.cells_in_work = 0;
  now.seconds = 3725.0;
  EXPECT_FALSE(is_last(now)) << "the neighbor check is left";
  now.seconds_left = 0.0;
  EXPECT_TRUE(is_last(now));
  EXPECT_EQ(progress_text(now, 80), "baked 60 cells in 1 h 02 min, error 1.2e-06, worst bound 9.9e-05, 3.21 % visible");
  EXPECT_EQ(progress_text(now, 20), "60 cells");
}

TEST(progress_text, importance_ends_at_100_percent) {
  progress now = without_slow_cell();
  now.phase = bake_phase::measuring_importance;
  now.importance = 0.99;
  EXPECT_FALSE(is_last(now));
  now.importance = 1.0;
  EXPECT_TRUE(is_last(now));
  EXPECT_EQ(progress_text(now, 40), "importance of polygons: 100 %");
}

TEST(progress_text, rates_are_in_a_unit_that_gives_digits) {
  progress now = without_slow_cell();
  const auto rate = [&](double cells_per_second) {
    now.cells_per_second = cells_per_second;
    const std::string text = progress_text(now, 120);
    const std::size_t begin = text.find(", ") + 2;
    return text.substr(begin, text.find(", ", begin) - begin);
  };
  EXPECT_EQ(rate(1234.0), "1234 cells/s");
  EXPECT_EQ(rate(1.25), "1.2 cells/s");
  EXPECT_EQ(rate(0.5), "0.50 cells/s");
  EXPECT_EQ(rate(0.05), "3.0 cells/min");
  EXPECT_EQ(rate(0.001), "3.6 cells/h");
}

TEST(progress_text, a_stop_has_the_cells_that_it_waits_for) {
  EXPECT_EQ(stopping_text(with_slow_cell(), 80), "stopping after 2 cells in work, cell 2 (-122, 7, -90) m for 34 s");
  EXPECT_EQ(stopping_text(with_slow_cell(), 50), "stopping after 2 cells in work, cell 2 for 34 s");
  EXPECT_EQ(stopping_text(with_slow_cell(), 40), "stopping after 2 cells in work");
  EXPECT_EQ(stopping_text(progress(), 40), "stopping");
}

TEST(progress_text, of_uncounted_work_has_its_time) {
  EXPECT_EQ(waiting_text("loading level.glb", 0.0, 40), "loading level.glb");
  EXPECT_EQ(waiting_text("loading level.glb", 12.3, 40), "loading level.glb, 12 s");
  EXPECT_EQ(waiting_text("loading level.glb", 12.3, 20), "loading level., 12 s");
  EXPECT_EQ(waiting_text("loading level.glb", 12.3, 4), "load");
  EXPECT_EQ(waiting_text("loading a\r\x1b[Kb", 0.0, 40), "loading a  [Kb") << "a name controls no terminal";
}

TEST(progress_text, is_cut_between_characters) {
  EXPECT_EQ(cut_to("\xC3\xA4\xC3\xA4", 4), "\xC3\xA4\xC3\xA4");
  EXPECT_EQ(cut_to("\xC3\xA4\xC3\xA4", 3), "\xC3\xA4");
  EXPECT_EQ(cut_to("a\xE5\xA4\xA9", 2), "a") << "it may be two columns wide";
}

TEST(progress_text, is_never_longer_than_the_width) {
  for (const progress& one : {with_slow_cell(), without_slow_cell(), large(), progress()})
    for (int phase = 0; phase <= static_cast<int>(bake_phase::measuring_importance); ++phase) {
      progress now = one;
      now.phase = static_cast<bake_phase>(phase);
      for (std::size_t width = 0; width <= 200; ++width) {
        EXPECT_LE(progress_text(now, width).size(), width);
        EXPECT_LE(stopping_text(now, width).size(), width);
        EXPECT_LE(waiting_text(std::string(phase_text(now.phase)), 1e4, width).size(), width);
      }
      for (const std::size_t width : widths) EXPECT_FALSE(progress_text(now, width).empty());
    }
}

TEST(progress_text, phases_have_names_of_their_own) {
  std::set<std::string_view> names, texts;
  for (int phase = 0; phase <= static_cast<int>(bake_phase::measuring_importance); ++phase) {
    names.insert(phase_name(static_cast<bake_phase>(phase)));
    texts.insert(phase_text(static_cast<bake_phase>(phase)));
  }
  EXPECT_EQ(names.size(), 10u);
  EXPECT_EQ(texts.size(), 10u);
  EXPECT_FALSE(names.contains(""));
}

}  // namespace
}  // namespace sightcell::cli
