#pragma once
// Which cells of a chunk are worth trying as references of each other, and which are taken.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

inline constexpr std::uint32_t no_cell = 0xFFFFFFFFu;

// The first cell with the same set, itself included. Allocates, as the others do.
std::vector<std::uint32_t> first_equal(std::span<const std::vector<run>> sets);

// For each cell that is first_equal to itself at most `count` others that are, the likest sets first: by how many
// members they have in each of 256 stretches of the numbers below limit, which is cheap enough to look at every pair.
std::vector<std::vector<std::uint32_t>> likely_references(std::span<const std::vector<run>> sets,
                                                          std::span<const std::uint32_t> first, std::uint32_t limit,
                                                          std::size_t count);

// A row of `cell` as the difference to `reference`, which is so much smaller than its own runs.
struct saving_difference {
  std::uint64_t saving = 0;
  std::uint32_t cell = 0;
  std::uint32_t reference = 0;
};

// The reference of each cell, or no_cell: takes differences by their saving while no chain of references gets longer
// than the format allows or bites its tail.
std::vector<std::uint32_t> choose_references(std::size_t cells, std::vector<saving_difference> differences);

}  // namespace sightcell::format
