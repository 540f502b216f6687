#pragma once
// Decides, for a cell whose batches of verification rays fail, what follows: hemicubes, a batch that may end early, or
// a batch that is cast to its end. Costs are in aimed rays.
#include <cstdint>
#include <span>
#include <vector>

#include "bound/sequential_test.h"

namespace sightcell::bake {

// Share of the miss probability that is left after another round of hemicubes, and after rays toward the neighbors of
// what a batch found.
inline constexpr double left_after_round = 0.45, left_after_rays = 0.7;

// Returns the part of the 5 % that batch number `batch`, from 1, may use.
double risk_of_batch(std::uint64_t batch);

// Returns whether a batch now costs less than another round of hemicubes and a shorter batch after it, in the mean
// over the estimates of the miss probability.
// missing: the estimates; 1 if nothing is known. Then a batch pays if its first interim test costs no more than the
//   hemicubes, because a cheap batch is the quickest estimate.
bool batch_pays(const std::vector<interim_test>& interim_tests, std::span<const double> missing,
                std::uint64_t cost_of_hemicubes, double cost_of_trial);

// A batch ends early where another search and a shorter batch seem cheaper. In a cell whose misses are many small
// polygons, each found alone, the next batch is no shorter, and has half of the risk. So after this many batches since
// the last hemicubes, the cheaper of two follows: a round of hemicubes, or a batch that is cast to its end and finds
// more misses.
inline constexpr std::uint64_t most_short_batches = 3;

// Returns whether a batch is cast to its end: until an interim test succeeds, or to the last.
// batches: how many there were since the last hemicubes.
constexpr bool batch_is_whole(std::uint64_t batches) noexcept {
  return batches >= most_short_batches;
}

// Returns whether a round of hemicubes follows a batch that failed, whatever batch_pays() returns.
// batches: how many there were since the last hemicubes, this one included.
// cost_of_hemicubes: of the next round.
// cost_of_whole_batch: of the next batch up to its last interim test.
constexpr bool hemicubes_follow(std::uint64_t batches, double cost_of_hemicubes, double cost_of_whole_batch) noexcept {
  return batch_is_whole(batches) && cost_of_hemicubes <= cost_of_whole_batch;
}

}  // namespace sightcell::bake
