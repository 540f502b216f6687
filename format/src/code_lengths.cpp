#include "code_lengths.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

#include "prefix_code.h"

namespace sightcell::format {
namespace {

// A symbol, or two packages of the level below.
struct package {
  std::uint64_t weight = 0;
  std::vector<std::uint8_t> symbols;
};

std::vector<package> leaves_of(const symbol_counts& counts) {
  std::vector<package> leaves;
  for (std::uint32_t s = 0; s < symbol_count; ++s) {
    if (counts[s] > 0) leaves.push_back({counts[s], {static_cast<std::uint8_t>(s)}});
  }
  // Of equal weights the higher symbol comes first, and gets the longer code.
  std::sort(leaves.begin(), leaves.end(), [](const package& a, const package& b) {
    return std::tie(a.weight, b.symbols.front()) < std::tie(b.weight, a.symbols.front());
  });
  return leaves;
}

std::vector<package> pairs_of(const std::vector<package>& level) {
  std::vector<package> pairs;
  for (std::size_t i = 0; i + 1 < level.size(); i += 2) {
    package both = level[i];
    both.weight += level[i + 1].weight;
    both.symbols.insert(both.symbols.end(), level[i + 1].symbols.begin(), level[i + 1].symbols.end());
    pairs.push_back(std::move(both));
  }
  return pairs;
}

}  // namespace

symbol_lengths best_lengths(const symbol_counts& counts, unsigned most_bits) {
  symbol_lengths lengths{};
  const std::vector<package> leaves = leaves_of(counts);
  if (leaves.size() == 1) lengths[leaves.front().symbols.front()] = 1;
  if (leaves.size() < 2) return lengths;
  std::vector<package> level = leaves;
  for (unsigned bits = 1; bits < most_bits; ++bits) {
    const std::vector<package> pairs = pairs_of(level);
    std::vector<package> merged;
    merged.reserve(leaves.size() + pairs.size());
    std::merge(leaves.begin(), leaves.end(), pairs.begin(), pairs.end(), std::back_inserter(merged),
               [](const package& a, const package& b) { return a.weight < b.weight; });
    level = std::move(merged);
  }
  // A symbol's code has one bit for each of the first 2 n - 2 packages that contain it.
  for (std::size_t i = 0; i < 2 * leaves.size() - 2; ++i) {
    for (const std::uint8_t symbol : level[i].symbols) ++lengths[symbol];
  }
  return lengths;
}

}  // namespace sightcell::format
