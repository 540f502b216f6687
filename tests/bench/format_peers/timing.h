#pragma once
// What decoding cell sets costs: the runtime beside its peers, in the same run.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/format_peers/corpus.h"
#include "bench/format_peers/peers.h"

namespace sightcell::bench {

struct timing_settings {
  unsigned repeat = 5;           // passes, of whose times of a cell the median counts
  std::uint64_t seed = 1;        // of the shuffled order
  std::size_t cold_cells = 200;  // of the shuffled order, its first ones
  std::size_t walk_bytes = std::size_t{64} << 20;
};

// Of one kind of call, the same cells in every pass.
struct call_times {
  std::string name;
  double ns_per_cell = 0.0;  // mean over cells of the median over passes
  double ns_per_run = 0.0;   // ranges as delivered where it is the runtime's, else runs in source order
  double ns_per_polygon = 0.0;
  double worst_cell_ns = 0.0;
  std::array<double, 3> ns_per_run_of_depth{};  // the same, of the cells whose rows have that depth; 0 without any
};

struct all_times {
  std::vector<call_times> shuffled, file_order;  // orders of the cells
  std::vector<call_times> cold;                  // move alone, a buffer walked before each
  double clock_ns = 0.0;                         // what reading the clock adds to each time; not subtracted
};

// The clock is std::chrono::steady_clock: reading that of the thread's CPU time would cost as much as a small cell. A
// pass that others interrupt is outvoted by the rest.
all_times measure(const corpus& of, const peer_rows& peers, const timing_settings& how);

}  // namespace sightcell::bench
