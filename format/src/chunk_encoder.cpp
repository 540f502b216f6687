#include "chunk_encoder.h"

#include "reference_choice.h"
#include "row_encoder.h"

namespace sightcell::format {
namespace {

constexpr std::size_t candidates_per_cell = 12;

// Every difference between like cells that is smaller than the cell's own runs.
std::vector<saving_difference> saving_differences(std::span<const std::vector<run>> sets,
                                                  std::span<const std::uint32_t> first, std::uint32_t polygon_count) {
  const auto likely = likely_references(sets, first, polygon_count, candidates_per_cell);
  std::vector<saving_difference> found;
  std::vector<run> removed;
  std::vector<run> added;
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) {
    const std::size_t own = own_row_size(sets[cell]);
    for (const std::uint32_t other : likely[cell]) {
      difference(sets[other], sets[cell], removed, added);
      const std::size_t size = delta_row_size(removed, added);
      if (size < own) found.push_back({own - size, cell, other});
    }
  }
  return found;
}

}  // namespace

encoded_chunk encode_chunk(std::span<const std::vector<run>> sets, std::uint32_t polygon_count) {
  const std::vector<std::uint32_t> first = first_equal(sets);
  const std::vector<std::uint32_t> reference =
      choose_references(sets.size(), saving_differences(sets, first, polygon_count));
  encoded_chunk chunk;
  std::vector<run> removed;
  std::vector<run> added;
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    if (first[cell] != cell) {
      chunk.rows.push_back(chunk.rows[first[cell]]);
      continue;
    }
    const std::uint64_t offset = chunk.bytes.size();
    if (reference[cell] == no_cell) {
      encode_own_row(sets[cell], chunk.bytes);
    } else {
      difference(sets[reference[cell]], sets[cell], removed, added);
      encode_delta_row(reference[cell], removed, added, chunk.bytes);
    }
    chunk.rows.push_back({offset, chunk.bytes.size() - offset});
  }
  return chunk;
}

}  // namespace sightcell::format
