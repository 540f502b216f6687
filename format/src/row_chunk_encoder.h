#pragma once
// Encodes the rows of one chunk (row_chunk.h is the way back): chooses for every cell whether its row stands alone, is
// the difference to another cell of the chunk, or is shared with an earlier cell; counts symbols, so that codes can be
// made of the counts of all chunks; writes.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "run_encoder.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// How often each symbol occurs in the three kinds of lists, and the longest list of differences.
struct row_counts {
  run_counts own, removed, added;
  std::uint32_t list_runs = 0;
};

struct row_encoders {
  explicit row_encoders(const row_counts& counts) : own(counts.own), removed(counts.removed), added(counts.added) {}
  run_encoder own, removed, added;
};

// For each cell of a chunk what its row is.
struct chunk_plan {
  static constexpr std::uint8_t alone = 0xFF;
  std::vector<std::uint8_t> same;       // the first cell with the same set: it has the row; itself where there is none
  std::vector<std::uint8_t> reference;  // the cell that the row is the difference to, or alone
};

// Which differences are taken: those that save at least an eighth of the row, as less is not worth decoding two; or all
// that save anything.
enum class least_saving { an_eighth, anything };

// sets: of 1 .. 64 cells; encoders: what lists will cost, or nearly. Same sets and encoders, same plan. Allocates; any
// thread.
chunk_plan plan_chunk(std::span<const std::vector<run>> sets, const row_encoders& encoders, std::uint32_t limit,
                      least_saving least = least_saving::an_eighth);

// Adds the symbols of the chunk's rows.
void count_chunk(std::span<const std::vector<run>> sets, const chunk_plan& plan, row_counts& counts);

// Appends the chunk. encoders: made of counts to which count_chunk has added this plan.
void encode_chunk(std::span<const std::vector<run>> sets, const chunk_plan& plan, const row_encoders& encoders,
                  std::vector<std::byte>& out);

}  // namespace sightcell::format
