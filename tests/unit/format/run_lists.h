#pragma once
// Sets for tests, as runs and as borders.
#include <cstdint>
#include <vector>

#include "rank_difference.h"
#include "sightcell/format/records.h"

namespace sightcell::test {

// The runs of the elements that are true.
inline std::vector<format::run> runs_of(const std::vector<bool>& members) {
  std::vector<format::run> runs;
  for (std::uint32_t i = 0; i < members.size(); ++i) {
    if (!members[i]) continue;
    if (!runs.empty() && runs.back().first + runs.back().count == i) {
      ++runs.back().count;
    } else {
      runs.push_back({i, 1});
    }
  }
  return runs;
}

// The first number of each run, and the one after its last.
inline std::vector<std::uint32_t> borders_of(const std::vector<format::run>& runs) {
  std::vector<std::uint32_t> borders;
  for (const format::run& r : runs) {
    borders.push_back(r.first);
    borders.push_back(r.first + r.count);
  }
  return borders;
}

// The same as a list for apply_rank_difference.
inline std::vector<std::uint32_t> closed_borders_of(const std::vector<format::run>& runs) {
  std::vector<std::uint32_t> borders = borders_of(runs);
  borders.insert(borders.end(), format::list_padding, format::no_border);
  return borders;
}

}  // namespace sightcell::test
