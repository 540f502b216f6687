#include "cells/cell_sizes.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "cells/lattice.h"

namespace sightcell::bake {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr int bisections = 100;  // more than a double has bits

// A square of a quadtree: a cell, or the cells that cover it.
struct square {
  lattice_position position;
  double drawn = never;    // as one cell
  std::size_t parent = 0;  // index of the square that contains it; its own index at the top
};

bool by_level(const square& a, const square& b) {
  return a.position.level != b.position.level ? a.position.level < b.position.level : a.position < b.position;
}

// All squares from the leaves up, and what is best for each at a price per cell.
class quadtrees {
 public:
  explicit quadtrees(std::span<const cell_option> options);

  // Decides for each square whether it is one cell. Returns what is drawn in all.
  double prune(double price);
  double drawn_by_leaves() const { return drawn_by_leaves_; }
  // Returns the cells of the last decision.
  std::vector<lattice_position> chosen() const;

 private:
  struct decision {
    double drawn = 0.0, cells = 0.0;  // of the squares inside; then of the better choice
    bool whole = false;
  };

  bool is_top(std::size_t i) const { return squares_[i].parent == i; }

  std::vector<square> squares_;  // by_level: a parent comes after its children
  std::vector<decision> best_;
  double drawn_by_leaves_ = 0.0;
};

quadtrees::quadtrees(std::span<const cell_option> options) {
  std::vector<square> given;
  for (const cell_option& option : options) {
    given.push_back({option.position, option.drawn});
    if (option.position.level == 0) drawn_by_leaves_ += option.drawn;
  }
  std::sort(given.begin(), given.end(), by_level);
  // Level by level: its options, and the squares around those of the level below, of which some are no options.
  auto next = given.begin();
  std::size_t below = 0;  // where the level below begins
  for (std::int32_t level = 0; next != given.end() || level == 0; ++level) {
    std::vector<square> squares;
    for (; next != given.end() && next->position.level == level; ++next) squares.push_back(*next);
    const std::size_t here = squares_.size();
    for (std::size_t i = below; i < here; ++i) squares.push_back({lattice::wider(squares_[i].position)});
    std::stable_sort(squares.begin(), squares.end(), by_level);  // an option comes before the same square without
    squares.erase(std::unique(squares.begin(), squares.end(),
                              [](const square& a, const square& b) { return a.position == b.position; }),
                  squares.end());
    squares_.insert(squares_.end(), squares.begin(), squares.end());
    for (std::size_t i = below; i < here; ++i) {
      const square parent{lattice::wider(squares_[i].position)};
      const auto at =
          std::lower_bound(squares_.begin() + static_cast<std::ptrdiff_t>(here), squares_.end(), parent, by_level);
      squares_[i].parent = static_cast<std::size_t>(at - squares_.begin());
    }
    below = here;
  }
  for (std::size_t i = below; i < squares_.size(); ++i) squares_[i].parent = i;
  best_.resize(squares_.size());
}

double quadtrees::prune(double price) {
  std::fill(best_.begin(), best_.end(), decision{});
  double drawn = 0.0;
  for (std::size_t i = 0; i < squares_.size(); ++i) {
    decision& best = best_[i];
    const double as_one = squares_[i].drawn;
    // Of equal choices the one with fewer cells.
    best.whole = squares_[i].position.level == 0 || as_one + price <= best.drawn + price * best.cells;
    if (best.whole) best.drawn = as_one, best.cells = 1.0;
    if (is_top(i)) {
      drawn += best.drawn;
      continue;
    }
    best_[squares_[i].parent].drawn += best.drawn;
    best_[squares_[i].parent].cells += best.cells;
  }
  return drawn;
}

std::vector<lattice_position> quadtrees::chosen() const {
  std::vector<lattice_position> found;
  std::vector<bool> covered(squares_.size(), false);
  for (std::size_t i = squares_.size(); i-- > 0;) {
    const bool by_parent = !is_top(i) && covered[squares_[i].parent];
    covered[i] = by_parent || best_[i].whole;
    if (best_[i].whole && !by_parent) found.push_back(squares_[i].position);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

std::vector<lattice_position> choose_cell_sizes(std::span<const cell_option> options, double growth) {
  quadtrees trees(options);
  const double most = (1.0 + growth) * trees.drawn_by_leaves();
  double low = 0.0, high = 1.0;  // at the highest price all squares are cells
  for (const cell_option& option : options) high += option.drawn;
  if (trees.prune(high) > most) {
    for (int i = 0; i < bisections; ++i) {
      const double middle = 0.5 * (low + high);
      (trees.prune(middle) > most ? high : low) = middle;
    }
    trees.prune(low);
  }
  return trees.chosen();
}

}  // namespace sightcell::bake
