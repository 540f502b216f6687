#pragma once
#include <cstdint>
#include <numeric>
#include <vector>

namespace sightcell::bake {

// A partition of the numbers 0 .. count - 1 into sets (union-find with path halving).
class disjoint_sets {
 public:
  explicit disjoint_sets(std::uint32_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

  std::uint32_t find(std::uint32_t x) {
    while (parents_[x] != x) x = parents_[x] = parents_[parents_[x]];
    return x;
  }
  void unite(std::uint32_t a, std::uint32_t b) { parents_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace sightcell::bake
