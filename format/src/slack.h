#pragma once
// Slack: polygons that are added to cell sets though nobody sees them, to make the file smaller and ranges fewer. No
// set loses one.
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

// What runs cost on average in lists with these counts, by codes that were made of them.
slack_prices slack_prices_of(const row_counts& counts, const row_encoders& encoders);

// Adds polygons to the sets of one chunk, to each at most share of its own. plan: of the sets as they are; equal sets
// stay equal. borders: of what ranges count in (range_borders.h). Same arguments, same sets. Adds to sums. Allocates
// about 60 bytes per border of the chunk's sets, borders of several sets counted once; any thread.
void add_slack(std::span<std::vector<run>> sets, const chunk_plan& plan, std::span<const std::uint32_t> borders,
               const slack_prices& prices, std::uint64_t share, slack_sums& sums);

}  // namespace sightcell::format
