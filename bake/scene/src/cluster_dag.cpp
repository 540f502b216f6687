#include "sightcell/scene/cluster_dag.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "cluster_groups.h"
#include "sightcell/scene/clusters.h"
#include "simplified_group.h"

namespace sightcell::scene {
namespace {

constexpr std::size_t most_clusters_of_group = 8;
// Spheres contain those below them for hosts that compute in single precision too.
constexpr float sphere_allowance = 1e-5f;
constexpr int steps_to_smallest_sphere = 32;
// Distances below this part of the coordinates are those of rounding.
constexpr double rounding_of_places = 1e-6;

// By vertex: a number that vertices in the same place share.
std::vector<std::uint32_t> numbers_of_positions(const std::vector<glm::vec3>& positions) {
  const auto bits = [&](std::uint32_t vertex) {
    const glm::vec3 p = positions[vertex] + 0.0f;  // -0 becomes 0
    return std::array{std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                      std::bit_cast<std::uint32_t>(p.z)};
  };
  std::vector<std::uint32_t> order(positions.size()), numbers(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return bits(a) < bits(b); });
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && bits(order[i]) != bits(order[i - 1])) ++number;
    numbers[order[i]] = number;
  }
  return numbers;
}

// Returns a sphere that contains others, and is nearly the smallest one: each step moves its center toward the sphere
// that reaches farthest, by less and less (Badoiu and Clarkson).
dag_sphere around(std::span<const dag_sphere> spheres) {
  glm::dvec3 center{0.0}, best{0.0};
  for (const dag_sphere& s : spheres) center += glm::dvec3(s.center) / static_cast<double>(spheres.size());
  double radius = std::numeric_limits<double>::infinity();
  for (int step = 0; step < steps_to_smallest_sphere; ++step) {
    double reach = 0.0;
    glm::dvec3 toward{0.0};
    for (const dag_sphere& s : spheres) {
      const glm::dvec3 away = glm::dvec3(s.center) - center;
      const double distance = glm::length(away), own = distance + static_cast<double>(s.radius);
      if (own <= reach) continue;
      reach = own;
      toward = distance > 0.0 ? away * (own / distance) : glm::dvec3(0.0);
    }
    if (reach < radius) radius = reach, best = center;
    center += toward / (step + 2.0);
  }
  dag_sphere out{glm::vec3(best), 0.0f};
  radius = 0.0;  // of the center in single precision
  for (const dag_sphere& s : spheres)
    radius = std::max(radius, glm::distance(glm::dvec3(s.center), glm::dvec3(out.center)) + s.radius);
  const float size = glm::length(out.center) + static_cast<float>(radius);
  out.radius = static_cast<float>(radius) + sphere_allowance * size;
  return out;
}

class dag_builder {
 public:
  explicit dag_builder(const geometry& mesh) : mesh_(mesh) {}

  cluster_dag run(bool levels) {
    add_leaves();
    const bool finite = std::all_of(mesh_.positions.begin(), mesh_.positions.end(), [](const glm::vec3& p) {
      return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    });
    if (!levels || !finite) return std::move(out_);
    positions_ = numbers_of_positions(mesh_.positions);
    std::vector<std::uint32_t> pending(out_.leaf_count);
    std::iota(pending.begin(), pending.end(), 0u);
    for (std::uint32_t level = 1; !pending.empty(); ++level) {
      const std::size_t before = out_.groups.size();
      pending = add_level(pending, level);
      if (out_.groups.size() == before) break;
    }
    return std::move(out_);
  }

 private:
  void add_leaves() {
    const mesh_clusters leaves = clusters_of(mesh_);
    out_.of_triangle = leaves.of_triangle;
    out_.leaf_count = leaves.count;
    out_.clusters.resize(leaves.count);
    for (const std::uint32_t cluster : leaves.of_triangle) ++out_.clusters[cluster].triangle_count;
    std::uint32_t first = 0;
    for (dag_cluster& cluster : out_.clusters) {
      cluster.first_triangle = first;
      first += cluster.triangle_count;
    }
    out_.indices.resize(mesh_.indices.size());
    std::vector<std::uint32_t> used(leaves.count, 0);
    for (std::size_t t = 0; t < leaves.of_triangle.size(); ++t) {
      const std::uint32_t cluster = leaves.of_triangle[t];
      const std::size_t at = out_.clusters[cluster].first_triangle + used[cluster]++;
      std::copy_n(&mesh_.indices[3 * t], 3, &out_.indices[3 * at]);
    }
  }

  std::span<const std::uint32_t> indices_of(const dag_cluster& cluster) const {
    return std::span(out_.indices)
        .subspan(std::size_t{3} * cluster.first_triangle, std::size_t{3} * cluster.triangle_count);
  }

  // Returns the sphere that decides whether a cluster is fine enough.
  dag_sphere sphere_of(const dag_cluster& cluster) const {
    if (cluster.made_by != no_index) return out_.groups[cluster.made_by].bounds;
    glm::vec3 min{std::numeric_limits<float>::max()}, max{std::numeric_limits<float>::lowest()};
    for (const std::uint32_t vertex : indices_of(cluster)) {
      min = glm::min(min, mesh_.positions[vertex]);
      max = glm::max(max, mesh_.positions[vertex]);
    }
    const glm::vec3 center = 0.5f * min + 0.5f * max;
    float radius = 0.0f;
    for (const std::uint32_t vertex : indices_of(cluster))
      radius = std::max(radius, glm::distance(mesh_.positions[vertex], center));
    return {center, radius + sphere_allowance * (glm::length(center) + radius)};
  }

  // Returns the clusters that are left for the next level.
  std::vector<std::uint32_t> add_level(const std::vector<std::uint32_t>& pending, std::uint32_t level) {
    const std::vector<std::vector<std::uint32_t>> groups = groups_of(pending);
    // By position: the group that has it, or several.
    constexpr std::uint32_t none = no_index, several = no_index - 1;
    std::vector<std::uint32_t> owner(mesh_.positions.size(), none);
    for (std::uint32_t g = 0; g < groups.size(); ++g)
      for (const std::uint32_t number : groups[g])
        for (const std::uint32_t vertex : indices_of(out_.clusters[number])) {
          std::uint32_t& of = owner[positions_[vertex]];
          of = of == none || of == g ? g : several;
        }
    std::vector<std::uint8_t> locked(owner.size());
    for (std::size_t i = 0; i < owner.size(); ++i) locked[i] = owner[i] == several;
    std::vector<std::uint32_t> left;
    for (const std::vector<std::uint32_t>& members : groups) {
      std::vector<std::uint32_t> indices;
      for (const std::uint32_t number : members) {
        const std::span<const std::uint32_t> of = indices_of(out_.clusters[number]);
        indices.insert(indices.end(), of.begin(), of.end());
      }
      const std::optional<simplified_group> made = simplify_group(mesh_, indices, positions_, locked);
      if (made)
        add_group(members, *made, level, left);
      else
        left.insert(left.end(), members.begin(), members.end());
    }
    return left;
  }

  std::vector<std::vector<std::uint32_t>> groups_of(const std::vector<std::uint32_t>& pending) const {
    std::vector<std::vector<std::uint32_t>> corners;
    std::vector<grouped_cluster> clusters;
    corners.reserve(pending.size());
    for (const std::uint32_t number : pending) {
      const dag_cluster& cluster = out_.clusters[number];
      std::vector<std::uint32_t>& own = corners.emplace_back();
      glm::dvec3 center{0.0};
      for (const std::uint32_t vertex : indices_of(cluster)) {
        own.push_back(positions_[vertex]);
        center += glm::dvec3(mesh_.positions[vertex]);
      }
      clusters.push_back({own, glm::vec3(center / static_cast<double>(own.size()))});
    }
    std::vector<std::vector<std::uint32_t>> groups = group_clusters(clusters, most_clusters_of_group);
    for (std::vector<std::uint32_t>& group : groups) {
      for (std::uint32_t& number : group) number = pending[number];
      std::sort(group.begin(), group.end());
    }
    return groups;
  }

  void add_group(const std::vector<std::uint32_t>& members, const simplified_group& made, std::uint32_t level,
                 std::vector<std::uint32_t>& left) {
    const auto number = static_cast<std::uint32_t>(out_.groups.size());
    dag_group group{.first_cluster = static_cast<std::uint32_t>(out_.clusters.size()),
                    .cluster_count = static_cast<std::uint32_t>(made.clusters.size()),
                    .bounds = {},
                    .level = level};
    std::vector<dag_sphere> spheres;
    float below = 0.0f;
    for (const std::uint32_t member : members) {
      dag_cluster& cluster = out_.clusters[member];
      spheres.push_back(sphere_of(cluster));
      if (cluster.made_by != no_index) below = std::max(below, out_.groups[cluster.made_by].error);
      cluster.group = number;
    }
    group.bounds = around(spheres);
    const double size = glm::length(glm::dvec3(group.bounds.center)) + static_cast<double>(group.bounds.radius);
    group.error = below;
    if (made.error > rounding_of_places * size)
      group.error = std::nextafter(below + static_cast<float>(made.error), std::numeric_limits<float>::infinity());
    for (const std::vector<std::uint32_t>& indices : made.clusters) {
      left.push_back(static_cast<std::uint32_t>(out_.clusters.size()));
      out_.clusters.push_back({.first_triangle = static_cast<std::uint32_t>(out_.indices.size() / 3),
                               .triangle_count = static_cast<std::uint32_t>(indices.size() / 3),
                               .made_by = number});
      out_.indices.insert(out_.indices.end(), indices.begin(), indices.end());
    }
    out_.groups.push_back(group);
  }

  const geometry& mesh_;
  cluster_dag out_;
  std::vector<std::uint32_t> positions_;  // by vertex: the number of its position
};

}  // namespace

bool may_have_levels(const scene& s, const draw& d) {
  const draw_tags& t = d.tags;
  const bool opaque = d.material == no_index || s.materials[d.material].alpha == alpha_mode::opaque;
  return opaque && !d.moves && !t.animated && t.occluder && t.group == no_index && d.lod_object == no_index;
}

cluster_dag build_cluster_dag(const geometry& mesh, bool levels) {
  return dag_builder(mesh).run(levels);
}

}  // namespace sightcell::scene
