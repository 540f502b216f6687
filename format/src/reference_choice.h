#pragma once
// Chooses which cells of a chunk are tried as references of each other, and which are used.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

inline constexpr std::uint32_t no_cell = 0xFFFFFFFFu;

// The first cell with an equal set, itself included. Allocates, as the others do.
std::vector<std::uint32_t> first_equal(std::span<const std::vector<run>> sets);

// For each cell that is first_equal to itself, up to `count` others that are, the most similar sets first. Similarity
// is by the number of members in each of 256 intervals below limit, which is cheap enough to compare every pair.
std::vector<std::vector<std::uint32_t>> likely_references(std::span<const std::vector<run>> sets,
                                                          std::span<const std::uint32_t> first, std::uint32_t limit,
                                                          std::size_t count);

// A row of `cell` as the difference to `reference`, and the bits that this saves.
struct saving_difference {
  std::uint64_t saving = 0;
  std::uint32_t cell = 0;
  std::uint32_t reference = 0;
};

// The reference of each cell, or no_cell. Takes differences by their saving, as long as no chain of references becomes
// a cycle or longer than the format allows.
std::vector<std::uint32_t> choose_references(std::size_t cells, std::vector<saving_difference> differences);

}  // namespace sightcell::format
