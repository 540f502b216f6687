#include "cluster_groups.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace sightcell::scene {
namespace {

struct border_neighbor {
  std::uint32_t cluster = 0, edges = 0;
};

// An edge, as the positions of its ends in ascending order, and a cluster with it.
using cluster_edge = std::array<std::uint32_t, 3>;

// By cluster: those that share an edge with it, by ascending number.
std::vector<std::vector<border_neighbor>> neighbors_of(std::span<const grouped_cluster> clusters) {
  std::vector<cluster_edge> edges;
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    const std::span<const std::uint32_t> corners = clusters[c].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t a = corners[i], b = corners[i % 3 == 2 ? i - 2 : i + 1];
      edges.push_back({std::min(a, b), std::max(a, b), c});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size() && edges[j][0] == edges[i][0] && edges[j][1] == edges[i][1]; ++j) {
      pairs.push_back({edges[i][2], edges[j][2]});
      pairs.push_back({edges[j][2], edges[i][2]});
    }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::vector<border_neighbor>> out(clusters.size());
  for (const auto& [from, to] : pairs) {
    if (out[from].empty() || out[from].back().cluster != to) out[from].push_back({to, 0});
    ++out[from].back().edges;
  }
  return out;
}

// Bits of a number of 10 bits, with two zeros after each.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 16) & 0x030000FFu;
  v = (v | v << 8) & 0x0300F00Fu;
  v = (v | v << 4) & 0x030C30C3u;
  return (v | v << 2) & 0x09249249u;
}

// Clusters along a curve that fills their space, so that those next to each other are close.
std::vector<std::uint32_t> along_curve(std::span<const grouped_cluster> clusters) {
  glm::vec3 min{std::numeric_limits<float>::max()}, max{std::numeric_limits<float>::lowest()};
  for (const grouped_cluster& c : clusters) min = glm::min(min, c.center), max = glm::max(max, c.center);
  std::vector<std::uint32_t> codes, order(clusters.size());
  for (const grouped_cluster& c : clusters) {
    std::uint32_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const float size = max[k] - min[k];
      const float part = size > 0.0f ? std::clamp((c.center[k] - min[k]) / size, 0.0f, 1.0f) : 0.0f;
      code |= spread(static_cast<std::uint32_t>(part * 1023.0f)) << k;
    }
    codes.push_back(code);
  }
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> group_clusters(std::span<const grouped_cluster> clusters, std::size_t most) {
  const std::vector<std::vector<border_neighbor>> neighbors = neighbors_of(clusters);
  const std::vector<std::uint32_t> order = along_curve(clusters);
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<std::uint8_t> taken(clusters.size(), 0);
  std::size_t next = 0;
  const auto next_free = [&] {
    while (next < order.size() && taken[order[next]]) ++next;
    return next < order.size();
  };
  std::vector<border_neighbor> candidates;  // free clusters beside the group, with the edges they share with it
  while (next_free()) {
    std::vector<std::uint32_t>& group = groups.emplace_back();
    candidates.clear();
    std::uint32_t chosen = order[next];
    for (;;) {
      taken[chosen] = 1;
      group.push_back(chosen);
      std::erase_if(candidates, [&](const border_neighbor& c) { return c.cluster == chosen; });
      if (group.size() == most) break;
      for (const border_neighbor& n : neighbors[chosen]) {
        if (taken[n.cluster]) continue;
        const auto known = std::find_if(candidates.begin(), candidates.end(),
                                        [&](const border_neighbor& c) { return c.cluster == n.cluster; });
        if (known == candidates.end())
          candidates.push_back(n);
        else
          known->edges += n.edges;
      }
      const auto best = std::max_element(candidates.begin(), candidates.end(),
                                         [](const border_neighbor& a, const border_neighbor& b) {
                                           return std::pair(a.edges, b.cluster) < std::pair(b.edges, a.cluster);
                                         });
      if (best != candidates.end())
        chosen = best->cluster;
      else if (next_free())
        chosen = order[next];
      else
        break;
    }
  }
  return groups;
}

}  // namespace sightcell::scene
