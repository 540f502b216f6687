#pragma once
// The sets of cells while a file is written. Each is read about ten times, and its record in a checkpoint has much more
// than the set, so sets are kept in memory as bytes: those of 1,786 cells of intel_castle, with 76,000 polygons in the
// mean, take 100 MB.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "cell_set/cell_record.h"

namespace sightcell::bake {

class kept_sets {
 public:
  // record_of: returns the record of a cell, for sets that are not kept; must outlive this.
  // most_bytes: the sets that are kept take at most this.
  kept_sets(const std::function<cell_record(std::uint32_t)>& record_of, std::uint64_t most_bytes)
      : record_of_(record_of), room_(most_bytes) {}

  // Returns the bytes of a set; none if it is not strictly ascending. Any thread.
  static std::vector<std::uint8_t> bytes_of(const std::vector<std::uint32_t>& set);

  // Keeps the set of a cell, as bytes, if there are some and there is room.
  void keep(std::uint32_t cell, std::vector<std::uint8_t> bytes);

  // Returns the set of a cell by its index in the list of cells. Any thread, while nothing is kept.
  std::vector<std::uint32_t> of(std::uint32_t cell) const;

  // Returns the mean of the bytes of the sets that are kept, at least 1.
  std::uint64_t mean_bytes() const;

 private:
  const std::function<cell_record(std::uint32_t)>& record_of_;
  std::uint64_t room_, taken_ = 0;
  std::unordered_map<std::uint32_t, std::vector<std::uint8_t>> bytes_;
};

}  // namespace sightcell::bake
