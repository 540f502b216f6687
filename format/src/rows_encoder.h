#pragma once
// Encodes the rows of a whole file. It reads all sets several times: the cost of a difference depends on the codes, and
// these depend on the chosen differences. Slack is added again each time, by prices that stay the same, but to the sets
// of the first blocks, which are kept. Work on different blocks of 64 cells may run at the same time: its results are
// added in the order of the blocks.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "chunk_split.h"
#include "range_borders.h"
#include "row_chunk_encoder.h"
#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"
#include "slack.h"
#include "stored_sets.h"

namespace sightcell::format {

class rows_encoder {
 public:
  // Both must outlive the encoder. unit_borders: where range units begin, in polygons or clusters, then their number.
  rows_encoder(const file_contents& contents, const stored_sets& stored, std::vector<std::uint32_t> unit_borders);

  // First step: chooses how each row is coded. argument: a set is not ascending, or contains a polygon or volume that
  // does not exist; the status of the source of the sets.
  status plan();
  // Known after plan.
  [[nodiscard]] std::vector<std::byte> codes() const;
  [[nodiscard]] std::vector<std::byte> borders() const { return encode_borders(blocks_); }  // empty: no section
  [[nodiscard]] std::uint32_t run_bound() const { return run_bound_; }
  [[nodiscard]] std::uint32_t range_bound() const { return range_bound_; }
  [[nodiscard]] std::uint32_t list_bound() const { return list_bound_; }
  [[nodiscard]] const slack_sums& sums() const { return sums_; }  // zeros without slack
  [[nodiscard]] std::size_t directory_size() const;

  // Second step: appends the rows section to file, and the directory to directory. limit: a chunk is too large.
  status write(std::vector<std::byte>& file, std::vector<std::byte>& directory);

 private:
  // A block while it is in work, and what the work found.
  struct block_work {
    std::vector<std::vector<run>> sets;
    std::vector<std::vector<run>> volumes;  // of the sets, while they are removed from them
    row_counts counts;
    slack_sums sums;
    bool is_widened = false;  // the sets have slack
    bool is_alone = false;    // no other block is in work, so its chunks may be
    std::uint32_t run_bound = 0;
    std::uint32_t range_bound = 0;
    std::vector<planned_chunk> chunks;
    std::vector<std::byte> rows;           // of its chunks, one after the other
    std::vector<std::size_t> chunk_sizes;  // in rows
    std::vector<std::uint32_t> checksums;  // of the chunks
  };

  // The sets of a block with slack.
  struct widened_block {
    std::vector<std::vector<run>> sets;
    slack_sums sums;
  };

  [[nodiscard]] std::size_t block_count() const;
  [[nodiscard]] std::size_t sample_step(std::size_t samples) const;
  // Calls work(block, w) for every step-th block, with its sets in w, and then use(block, w), which returns a status.
  // work: changes nothing but w and what belongs to its block. It may run for several blocks at the same time.
  // use: in the order of the blocks, on the calling thread.
  template <class Work, class Use>
  status for_each_block(std::size_t step, const Work& work, const Use& use);
  status read_sets(std::size_t first_cell, std::span<std::vector<run>> sets) const;
  // Those that are kept are not read.
  status read_group(std::size_t first, std::size_t step, std::span<block_work> group) const;
  status count_own(row_counts& counts);
  status sample(row_counts& counts);
  status sample_slack(row_counts& counts);
  status choose(const row_encoders& encoders, row_counts& counts);
  void widen_sets(std::size_t block, block_work& w);
  // Keeps the sets with slack for the next pass, if there is room. Removes them from w.
  void keep_widened(std::size_t block, block_work& w);
  [[nodiscard]] plan_settings how_to_plan(const block_work& w, least_saving least) const;
  [[nodiscard]] std::vector<planned_chunk> planned(std::size_t block, block_work& w,
                                                   const row_encoders& encoders) const;
  // Removes the volumes from the sets, or puts them back.
  void take_volumes(block_work& w) const;
  static void put_volumes_back(block_work& w);
  [[nodiscard]] std::uint32_t count_ranges(std::span<const run> runs) const;

  const file_contents& contents_;
  const stored_sets& stored_;
  std::uint32_t columns_ = 0;           // polygons, or clusters
  std::uint32_t items_ = 0;             // these and volumes
  std::vector<std::uint32_t> borders_;  // of range units in items; volumes are one more
  std::vector<std::vector<planned_chunk>> blocks_;
  std::unique_ptr<row_encoders> encoders_;
  std::uint64_t slack_share_ = 0;                 // in slack_share_units
  std::unique_ptr<row_encoders> exact_encoders_;  // for sets without slack; null until it is made
  slack_prices prices_;
  std::vector<std::vector<planned_chunk>> exact_blocks_;  // by which slack is added; empty ones are made later
  std::vector<widened_block> widened_;                    // by block; without sets where they are not kept
  std::size_t widened_runs_ = 0;                          // in all of these
  slack_sums sums_;
  std::uint32_t run_bound_ = 0;
  std::uint32_t range_bound_ = 0;
  std::uint32_t list_bound_ = 0;
};

}  // namespace sightcell::format
