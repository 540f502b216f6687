#include "verify/cut_scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

namespace sightcell::bake {

using scene::no_index;

namespace {

// The levels of a geometry, for the draws that have some, and its leaves for all others.
struct built_dag {
  scene::cluster_dag levels, leaves;
};

bool has_area(const scene::world_geometry& world, std::uint32_t polygon) {
  const std::uint32_t* corner = &world.indices[3 * std::size_t{polygon}];
  const glm::dvec3 a(world.positions[corner[0]]), b(world.positions[corner[1]]), c(world.positions[corner[2]]);
  return glm::cross(b - a, c - a) != glm::dvec3(0.0);
}

// Whether coarser triangles can take the place of the polygons of a draw, also with the overrides of the file.
bool has_levels(const scene::scene& s, const scene::draw& d, const scene::world_geometry& world) {
  if (!scene::may_have_levels(s, d)) return false;
  const scene::polygon_kind* first = nullptr;
  for (std::uint32_t polygon = d.first_source; polygon < d.first_source + d.polygon_count; ++polygon) {
    const scene::polygon_kind& kind = world.kinds[polygon];
    if (kind.absent) {
      if (has_area(world, polygon)) return false;
      continue;
    }
    if (!kind.occludes() || kind.alpha_tested) return false;  // BLEND, marks, masks
    if (first == nullptr) first = &kind;
    if (kind.double_sided != first->double_sided || kind.always != first->always) return false;
  }
  return first != nullptr;
}

// How much a transform enlarges, at most: the root of the greatest row sum of M^T M bounds its greatest stretch.
double greatest_stretch(const glm::dmat4& to_world) {
  const glm::dmat3 m(to_world);
  const glm::dmat3 product = glm::transpose(m) * m;
  double most = 0.0;
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 c = product[column];
    most = std::max(most, std::abs(c.x) + std::abs(c.y) + std::abs(c.z));
  }
  return std::sqrt(most);
}

}  // namespace

cut_scene::cut_scene(const scene::scene& s, const scene::world_geometry& world)
    : geometry_(world), polygons_(s.polygon_count) {
  std::vector<std::uint8_t> with_levels(s.draws.size()), needs_levels(s.geometries.size()), needs_leaves(needs_levels);
  for (std::size_t i = 0; i < s.draws.size(); ++i) {
    with_levels[i] = has_levels(s, s.draws[i], world) ? 1 : 0;
    (with_levels[i] ? needs_levels : needs_leaves)[s.draws[i].geometry] = 1;
  }
  std::vector<built_dag> dags(s.geometries.size());
  tbb::parallel_for(std::size_t{0}, dags.size(), [&](std::size_t i) {
    if (needs_leaves[i]) dags[i].leaves = scene::build_cluster_dag(s.geometries[i], false);
    if (needs_levels[i]) dags[i].levels = scene::build_cluster_dag(s.geometries[i]);
  });
  cluster_of_.resize(polygons_);
  for (std::size_t i = 0; i < s.draws.size(); ++i) {
    const built_dag& built = dags[s.draws[i].geometry];
    place(s.draws[i], static_cast<std::uint32_t>(i), with_levels[i] ? built.levels : built.leaves);
  }
}

void cut_scene::place(const scene::draw& d, std::uint32_t draw, const scene::cluster_dag& dag) {
  const auto first_cluster = static_cast<std::uint32_t>(clusters_.size());
  const auto first_group = static_cast<std::uint32_t>(groups_.size());
  const auto placed = [&](std::uint32_t group) { return group == no_index ? no_index : first_group + group; };
  for (const scene::dag_cluster& cluster : dag.clusters)
    clusters_.push_back({placed(cluster.made_by), placed(cluster.group), cluster.triangle_count, draw,
                         static_cast<std::uint32_t>(clusters_.size()) - first_cluster});
  for (std::uint32_t t = 0; t < d.polygon_count; ++t)
    cluster_of_[d.first_source + t] = first_cluster + dag.of_triangle[t];
  leaves_ += dag.leaf_count;
  if (dag.groups.empty()) return;

  const double stretch = greatest_stretch(d.to_world);
  for (const scene::dag_group& group : dag.groups)
    groups_.push_back({glm::vec3(d.to_world * glm::dvec4(group.bounds.center, 1.0)),
                       static_cast<float>(stretch * group.bounds.radius), static_cast<float>(stretch * group.error)});
  const bool mirrored = glm::determinant(glm::dmat3(d.to_world)) < 0.0;
  scene::polygon_kind kind;
  for (std::uint32_t t = 0; t < d.polygon_count; ++t)
    if (!geometry_.kinds[d.first_source + t].absent) kind = geometry_.kinds[d.first_source + t];
  for (std::uint32_t c = dag.leaf_count; c < dag.clusters.size(); ++c) {
    const scene::dag_cluster& cluster = dag.clusters[c];
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      const std::uint32_t* corner = &dag.indices[3 * std::size_t{t}];
      for (const std::size_t k : {0, mirrored ? 2 : 1, mirrored ? 1 : 2})
        geometry_.indices.push_back(d.base_vertex + corner[k]);
      geometry_.kinds.push_back(kind);
      if (!has_area(geometry_, static_cast<std::uint32_t>(geometry_.kinds.size() - 1)))
        geometry_.kinds.back().absent = true;
      cluster_of_.push_back(first_cluster + c);
    }
  }
}

bool cut_scene::is_fine(std::uint32_t number, const glm::vec3& eye, float error_at_1) const {
  const placed_group& group = groups_[number];
  return group.error <= error_at_1 * std::max(0.0f, glm::distance(eye, group.center) - group.radius);
}

bool cut_scene::in_cut(std::uint32_t number, const glm::vec3& eye, float error_at_1) const {
  const placed_cluster& cluster = clusters_[number];
  return (cluster.made_by == no_index || is_fine(cluster.made_by, eye, error_at_1)) &&
         (cluster.group == no_index || !is_fine(cluster.group, eye, error_at_1));
}

void cut_scene::find_visible(const std::function<bool(std::uint32_t)>& has, std::vector<std::uint8_t>& visible) const {
  visible.assign(clusters_.size(), 0);
  for (std::uint32_t polygon = 0; polygon < polygons_; ++polygon)
    if (has(polygon)) visible[cluster_of_[polygon]] = 1;
  // Groups and clusters follow those below them, so one pass suffices.
  std::vector<std::uint8_t> group_visible(groups_.size(), 0);
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    const placed_cluster& cluster = clusters_[c];
    if (cluster.made_by != no_index) visible[c] = group_visible[cluster.made_by];
    if (cluster.group != no_index) group_visible[cluster.group] |= visible[c];
  }
}

}  // namespace sightcell::bake
