#include "stream/patches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr std::uint32_t polygons_of_patch = 64;
constexpr std::uint32_t shared_components = sketch_size / 4;

std::uint32_t similarity(const sketch& a, const sketch& b) {
  std::uint32_t shared = 0;
  for (std::size_t i = 0; i < sketch_size; ++i) shared += a[i] == b[i];
  return shared;
}

struct neighbor_pair {
  std::uint32_t similarity = 0;
  std::uint32_t a = 0, b = 0;  // places in the list of polygons
};

// Returns pairs that share an edge and are similar, the most similar ones first.
std::vector<neighbor_pair> similar_neighbors(std::span<const std::uint32_t> polygons,
                                             std::span<const std::uint32_t> corners,
                                             const std::function<const sketch&(std::uint32_t)>& seen) {
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> edges;
  for (std::uint32_t i = 0; i < polygons.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t* const c = &corners[3 * std::size_t{polygons[i]}];
      const std::uint32_t from = c[k], to = c[(k + 1) % 3];
      edges.push_back({{std::min(from, to), std::max(from, to)}, i});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<neighbor_pair> pairs;
  for (std::size_t e = 1; e < edges.size(); ++e) {
    const std::uint32_t a = edges[e - 1].second, b = edges[e].second;
    if (edges[e - 1].first != edges[e].first || a == b) continue;
    const std::uint32_t shared = similarity(seen(polygons[a]), seen(polygons[b]));
    if (shared >= shared_components) pairs.push_back({shared, a, b});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& x, const auto& y) { return x.similarity > y.similarity; });
  return pairs;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> patches_of(std::span<const std::uint32_t> polygons,
                                                   std::span<const std::uint32_t> corners,
                                                   const std::function<const sketch&(std::uint32_t)>& seen) {
  std::vector<std::uint32_t> parent(polygons.size()), size(polygons.size(), 1);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root_of = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const neighbor_pair& pair : similar_neighbors(polygons, corners, seen)) {
    const std::uint32_t a = root_of(pair.a), b = root_of(pair.b), first = std::min(a, b), second = std::max(a, b);
    if (first == second || size[first] + size[second] > polygons_of_patch) continue;
    parent[second] = first;
    size[first] += size[second];
  }
  std::vector<std::vector<std::uint32_t>> out;
  std::vector<std::uint32_t> number(polygons.size());
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    const std::uint32_t root = root_of(i);  // never after i
    if (root == i) number[i] = static_cast<std::uint32_t>(out.size()), out.emplace_back();
    out[number[root]].push_back(polygons[i]);
  }
  return out;
}

}  // namespace sightcell::bake
