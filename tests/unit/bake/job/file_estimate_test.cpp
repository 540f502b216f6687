#include "job/file_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace {

using sightcell::bake::choose_trials;

TEST(file_estimate, trials_are_the_middles_of_equal_parts) {
  std::vector<std::uint32_t> trials = choose_trials(1000, 10);
  std::sort(trials.begin(), trials.end());
  EXPECT_EQ(trials, (std::vector<std::uint32_t>{50, 150, 250, 350, 450, 550, 650, 750, 850, 950}));
  EXPECT_EQ(choose_trials(7, 1), std::vector<std::uint32_t>{3});
}

// Trials of slow cells end after a few.
TEST(file_estimate, the_first_trials_are_spread_too) {
  std::vector<std::uint32_t> trials = choose_trials(3200, 32);
  trials.resize(8);
  for (std::uint32_t part = 0; part < 8; ++part)
    EXPECT_EQ(std::count_if(trials.begin(), trials.end(), [&](auto cell) { return cell / 400 == part; }), 1) << part;
}

}  // namespace
