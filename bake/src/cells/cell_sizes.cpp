#include "cells/cell_sizes.h"

#include <algorithm>

namespace sightcell::bake {
namespace {

constexpr int bisections = 100;  // more than a double has bits

// What is best for each option at a price per cell.
class pruning {
 public:
  explicit pruning(std::span<const cell_option> options) : options_(options), best_(options.size()) {}

  // Decides for each option whether it is one cell. Returns what is drawn in all.
  double prune(double price);
  // Returns the cells of the last decision.
  std::vector<std::size_t> chosen() const;

 private:
  struct decision {
    double drawn = 0.0, cells = 0.0;  // of the options inside; then of the better choice
    bool whole = false;
  };

  bool is_top(std::size_t i) const { return options_[i].parent == i; }

  const std::span<const cell_option> options_;
  std::vector<decision> best_;
};

double pruning::prune(double price) {
  std::fill(best_.begin(), best_.end(), decision{});
  double drawn = 0.0;
  for (std::size_t i = 0; i < options_.size(); ++i) {
    decision& best = best_[i];
    const double as_one = options_[i].drawn;
    // Of equal choices the one with fewer cells.
    best.whole = options_[i].smallest || as_one + price <= best.drawn + price * best.cells;
    if (best.whole) best.drawn = as_one, best.cells = 1.0;
    if (is_top(i)) {
      drawn += best.drawn;
      continue;
    }
    best_[options_[i].parent].drawn += best.drawn;
    best_[options_[i].parent].cells += best.cells;
  }
  return drawn;
}

std::vector<std::size_t> pruning::chosen() const {
  std::vector<std::size_t> found;
  std::vector<bool> covered(options_.size(), false);
  for (std::size_t i = options_.size(); i-- > 0;) {
    const bool by_parent = !is_top(i) && covered[options_[i].parent];
    covered[i] = by_parent || best_[i].whole;
    if (best_[i].whole && !by_parent) found.push_back(i);
  }
  std::reverse(found.begin(), found.end());
  return found;
}

}  // namespace

std::vector<std::size_t> choose_cell_sizes(std::span<const cell_option> options, double growth) {
  pruning trees(options);
  double smallest = 0.0, low = 0.0, high = 1.0;  // at the highest price all that may be cells are
  for (const cell_option& option : options) {
    if (option.smallest) smallest += option.drawn;
    if (option.drawn != cell_option::not_a_cell) high += option.drawn;
  }
  const double most = (1.0 + growth) * smallest;
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
