#pragma once
// Cell set -> bytes of one row (SPEC.md, "Rows"). row_decoder.h is the way back. A set is a span of runs: ascending,
// disjoint, not touching.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

// Runs of strictly ascending numbers. Allocates.
std::vector<run> runs_of(std::span<const std::uint32_t> ascending);

// What to remove from reference and what to add to get set. Both replaced. Allocates.
void difference(std::span<const run> reference, std::span<const run> set, std::vector<run>& removed,
                std::vector<run>& added);

// Bytes that encode_own_row and encode_delta_row append.
std::size_t own_row_size(std::span<const run> set);
std::size_t delta_row_size(std::span<const run> removed, std::span<const run> added);

void encode_own_row(std::span<const run> set, std::vector<std::byte>& out);
// reference: place of the reference cell in its chunk, below 64.
void encode_delta_row(std::uint32_t reference, std::span<const run> removed, std::span<const run> added,
                      std::vector<std::byte>& out);

}  // namespace sightcell::format
