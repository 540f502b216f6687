#pragma once
// The rows of a whole file. All sets are asked for several times: what a difference costs is known only when the codes
// are, and these are made of what was chosen. Slack is added anew each time, by prices that stay the same.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "range_borders.h"
#include "row_chunk_encoder.h"
#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"
#include "slack.h"
#include "stored_sets.h"

namespace sightcell::format {

class rows_encoder {
 public:
  // Both must outlive the encoder.
  rows_encoder(const file_contents& contents, stored_sets& stored);

  // First: chooses how each row is coded. argument: a set is not ascending, or holds a polygon or volume that there is
  // not; what the source of the sets answers.
  status plan();
  // Known since then.
  [[nodiscard]] std::vector<std::byte> codes() const;
  [[nodiscard]] std::uint32_t run_bound() const { return run_bound_; }
  [[nodiscard]] std::uint32_t range_bound() const { return range_bound_; }
  [[nodiscard]] std::uint32_t list_bound() const { return list_bound_; }
  [[nodiscard]] const slack_sums& sums() const { return sums_; }  // zeros where no slack was asked for
  [[nodiscard]] std::size_t directory_size() const;

  // Then: appends the rows section to file, and the directory to directory. limit: a chunk is too large.
  status write(std::vector<std::byte>& file, std::vector<std::byte>& directory);

 private:
  [[nodiscard]] std::size_t chunk_count() const;
  [[nodiscard]] std::size_t sample_step(std::size_t samples) const;
  // Calls visit(chunk) for every step-th chunk, with its sets in sets_; it answers a status.
  template <class Visit>
  status for_each_chunk(std::size_t step, const Visit& visit);
  status read_set(std::uint32_t cell, std::vector<run>& runs);
  status count_own(row_counts& counts);
  status sample(row_counts& counts);
  status sample_slack(row_counts& counts);
  status choose(const row_encoders& encoders, row_counts& counts);
  void widen_sets(std::size_t chunk, slack_sums& sums);
  // Of the sets in sets_: takes what they have from the first volume on, or puts it back.
  void take_volumes();
  void put_volumes_back();
  [[nodiscard]] std::uint32_t count_ranges(std::span<const run> runs) const;

  const file_contents& contents_;
  stored_sets& stored_;
  std::uint32_t items_ = 0;             // polygons and volumes
  std::vector<std::uint32_t> borders_;  // of what ranges count in; volumes are one more
  std::vector<chunk_plan> plans_;
  std::unique_ptr<row_encoders> encoders_;
  std::uint64_t slack_share_ = 0;                 // in slack_share_units
  std::unique_ptr<row_encoders> exact_encoders_;  // for sets without slack; null while there is none
  slack_prices prices_;
  std::vector<chunk_plan> exact_plans_;  // by which slack is added; empty ones are still to be made
  slack_sums sums_;
  std::uint32_t run_bound_ = 0;
  std::uint32_t range_bound_ = 0;
  std::uint32_t list_bound_ = 0;
  std::vector<std::uint32_t> ids_;
  std::vector<std::vector<run>> sets_;
  std::vector<std::vector<run>> volumes_;  // of these, while they are taken
};

}  // namespace sightcell::format
