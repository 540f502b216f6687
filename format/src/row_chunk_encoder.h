#pragma once
// Encodes the rows of one chunk (the counterpart for reading is row_chunk.h): chooses for each cell whether its row is
// an own row, the difference to another cell of the chunk, or shared with an earlier cell; counts symbols, from which
// the codes of all chunks are made; writes.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "run_encoder.h"
#include "sightcell/format/records.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Counts of each symbol in the three kinds of lists, and the longest list of a difference.
struct row_counts {
  run_counts own, removed, added;
  std::uint32_t list_runs = 0;

  void add(const row_counts& others);
};

struct row_encoders {
  explicit row_encoders(const row_counts& counts) : own(counts.own), removed(counts.removed), added(counts.added) {}
  run_encoder own, removed, added;
};

// How the row of each cell of a chunk is coded.
struct chunk_plan {
  static constexpr std::uint8_t alone = 0xFF;
  std::vector<std::uint8_t>
      same;  // the first cell with an equal set, which has the row; itself if there is none before
  std::vector<std::uint8_t> reference;  // the reference of a difference, or alone
};

// Which differences are used: those that save at least an eighth of the row, since decoding two rows costs more; or all
// that save anything.
enum class least_saving { an_eighth, anything };

struct plan_settings {
  least_saving least = least_saving::an_eighth;
  work_runner run_at_once = {};  // for the cells of the chunk; empty: the calling thread does all
};

// sets: of 1 .. 64 cells. encoders: the expected costs of lists. Equal sets, encoders and least savings give equal
// plans. Allocates; any thread.
chunk_plan plan_chunk(std::span<const std::vector<run>> sets, const row_encoders& encoders, std::uint32_t limit,
                      const plan_settings& how = {});

// The expected size of the row of each cell in bytes; 0 for a cell that has the row of another one.
std::vector<std::uint64_t> row_bytes(std::span<const std::vector<run>> sets, const chunk_plan& plan,
                                     const row_encoders& encoders);

// Adds the symbols of the chunk's rows.
void count_chunk(std::span<const std::vector<run>> sets, const chunk_plan& plan, row_counts& counts);

// Appends the chunk. encoders: made from counts to which count_chunk has added this plan.
void encode_chunk(std::span<const std::vector<run>> sets, const chunk_plan& plan, const row_encoders& encoders,
                  std::vector<std::byte>& out);

}  // namespace sightcell::format
