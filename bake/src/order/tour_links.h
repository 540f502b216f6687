#pragma once
// A tour, or fragments of one, as links without a direction: each row has up to two neighbors.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "order/neighbor_lists.h"

namespace sightcell::bake {

class tour_links {
 public:
  explicit tour_links(std::uint32_t rows) : links_(rows, {no_row, no_row}) {}
  // Makes a closed tour: the last row is linked to the first.
  explicit tour_links(std::span<const std::uint32_t> tour) : links_(tour.size()) {
    for (std::size_t i = 0; i < tour.size(); ++i)
      links_[tour[i]] = {tour[i == 0 ? tour.size() - 1 : i - 1], tour[i + 1 == tour.size() ? 0 : i + 1]};
  }

  const std::array<std::uint32_t, 2>& of(std::uint32_t row) const { return links_[row]; }
  bool full(std::uint32_t row) const { return links_[row][1] != no_row; }
  // Links two rows, of which neither may be full.
  void link(std::uint32_t a, std::uint32_t b) {
    links_[a][links_[a][0] == no_row ? 0 : 1] = b;
    links_[b][links_[b][0] == no_row ? 0 : 1] = a;
  }
  // Returns the neighbor of row that is not `from`.
  std::uint32_t beyond(std::uint32_t row, std::uint32_t from) const {
    return links_[row][links_[row][0] == from ? 1 : 0];
  }
  // Links row to `to` instead of `from`. The links of `from` and `to` do not change.
  void relink(std::uint32_t row, std::uint32_t from, std::uint32_t to) {
    links_[row][links_[row][0] == from ? 0 : 1] = to;
  }

  // Returns the rows of a closed tour of at least 3 rows, from first on, in the direction away from last, its neighbor.
  std::vector<std::uint32_t> tour_from(std::uint32_t first, std::uint32_t last) const {
    std::vector<std::uint32_t> tour;
    tour.reserve(links_.size());
    for (std::uint32_t before = last, row = first;;) {
      tour.push_back(row);
      if (row == last) return tour;
      const std::uint32_t next = beyond(row, before);
      before = row;
      row = next;
    }
  }

 private:
  std::vector<std::array<std::uint32_t, 2>> links_;
};

}  // namespace sightcell::bake
