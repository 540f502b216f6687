#pragma once
// Slack: invisible polygons that are added to cell sets, to make the file smaller and ranges fewer. No set loses a
// polygon.
#include <cstdint>
#include <span>
#include <vector>

#include "row_chunk_encoder.h"
#include "sightcell/format/records.h"
#include "slack_path.h"

namespace sightcell::format {

// A share of polygons in millionths: budgets are counted, not rounded.
inline constexpr std::uint64_t slack_share_unit = 1000000;

// Polygons of all sets together.
struct slack_sums {
  std::uint64_t seen = 0;
  std::uint64_t added = 0;
};

// The average cost of runs in lists with these counts, by codes that were made from them.
slack_prices slack_prices_of(const row_counts& counts, const row_encoders& encoders);

// Adds polygons to the sets of one chunk, to each up to share of its own number. plan: of the sets before; equal sets
// stay equal. borders: of range units (range_borders.h). Equal arguments give equal sets. Adds to sums. Allocates about
// 60 bytes per different border of the chunk's sets; any thread.
void add_slack(std::span<std::vector<run>> sets, const chunk_plan& plan, std::span<const std::uint32_t> borders,
               const slack_prices& prices, std::uint64_t share, slack_sums& sums);

}  // namespace sightcell::format
