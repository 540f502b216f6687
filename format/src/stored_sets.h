#pragma once
// Sets of source ids, and of volumes behind them, -> runs in the order that a file stores.
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

class stored_sets {
 public:
  // draws: in stored order, gapless by first_stored, and their source ids are all below the number of polygons, each
  // once. order_of_draw: as many; which of the orders a draw has. orders: permutations, each as long as the draws that
  // have it, or as the draws of its draw group together. volumes: how many. Nothing of them is kept.
  stored_sets(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw,
              std::span<const std::vector<std::uint32_t>> orders, host_layout layout = host_layout::instanced,
              std::uint32_t volumes = 0);

  // Stored polygons of a set of source ids, each once, in any order; the numbers of volumes, which begin where those
  // end, stay. runs is replaced. Not for two threads at once.
  void runs_of(std::span<const std::uint32_t> source_ids, std::vector<run>& runs);

 private:
  std::vector<std::uint32_t> stored_of_source_;
  std::vector<std::uint64_t> members_;  // a bit for each polygon and volume and one behind them; empty between calls
};

}  // namespace sightcell::format
