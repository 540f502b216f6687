#include "simplified_group.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "sightcell/scene/clusters.h"
#include "surface_distance.h"

namespace sightcell::scene {
namespace {

constexpr std::size_t most_vertices_of_cluster = 128;
constexpr double most_of_triangles = 0.8;   // where more remain, nothing is gained
constexpr float farthest_collapse = 0.25f;  // meshoptimizer's error, of the size of the group

// The vertices of a group with numbers of their own. Those that differ in their normals alone have one number, so that
// hard edges can be simplified.
struct group_mesh {
  std::vector<std::uint32_t> places;  // by number: that of its position
  std::vector<glm::vec2> uvs;         // by number
  std::vector<glm::vec3> positions;   // by number, then copies that lock them
  std::vector<std::uint32_t> indices;
};

// meshoptimizer moves no vertex that has three copies or more in the same place.
constexpr std::uint32_t copies_that_lock = 3;

using vertex_key = std::array<std::uint32_t, 4>;

// What vertices with one number have in common: their position, texture coordinates and color.
vertex_key key_of(const geometry& mesh, std::uint32_t vertex, std::uint32_t place) {
  vertex_key key{place, 0, 0, 0};
  if (!mesh.uvs.empty()) {
    key[1] = std::bit_cast<std::uint32_t>(mesh.uvs[vertex].x);
    key[2] = std::bit_cast<std::uint32_t>(mesh.uvs[vertex].y);
  }
  if (!mesh.colors.empty()) key[3] = std::bit_cast<std::uint32_t>(mesh.colors[vertex]);
  return key;
}

group_mesh compact(const geometry& mesh, std::span<const std::uint32_t> indices,
                   std::span<const std::uint32_t> positions, std::span<const std::uint8_t> locked) {
  group_mesh out;
  std::map<vertex_key, std::uint32_t> numbers;
  std::map<std::uint32_t, std::uint32_t> copies;
  for (const std::uint32_t vertex : indices) {
    const std::uint32_t place = positions[vertex];
    const auto [found, is_new] =
        numbers.try_emplace(key_of(mesh, vertex, place), static_cast<std::uint32_t>(out.places.size()));
    out.indices.push_back(found->second);
    if (!is_new) continue;
    out.places.push_back(place);
    out.uvs.push_back(mesh.uvs.empty() ? glm::vec2(0.0f) : mesh.uvs[vertex]);
    out.positions.push_back(mesh.positions[vertex] + 0.0f);  // -0 becomes 0, because meshoptimizer compares bits
    ++copies[place];
  }
  for (std::size_t i = 0; i < out.places.size(); ++i) {
    if (!locked[out.places[i]]) continue;
    for (std::uint32_t& n = copies[out.places[i]]; n < copies_that_lock; ++n)
      out.positions.push_back(glm::vec3(out.positions[i]));
  }
  return out;
}

glm::vec3 normal_of_triangle(const group_mesh& group, const std::uint32_t* corners) {
  const glm::dvec3 a(group.positions[corners[0]]), b(group.positions[corners[1]]), c(group.positions[corners[2]]);
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double length = glm::length(n);
  return length > 0.0 ? glm::vec3(n / length) : glm::vec3(0.0f);
}

// Turns numbers of a group into vertices of the mesh. Where several have one number, a corner takes that of the
// triangle before simplification whose direction is the nearest.
class corner_choice {
 public:
  // indices: the vertices of the mesh that group.indices are made of.
  corner_choice(const group_mesh& group, std::span<const std::uint32_t> indices) : uses_(group.places.size()) {
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (i % 3 == 0) normals_.push_back(normal_of_triangle(group, &group.indices[i]));
      uses_[group.indices[i]].push_back({indices[i], static_cast<std::uint32_t>(i / 3)});
    }
  }

  std::uint32_t vertex(std::uint32_t number, const glm::vec3& normal) const {
    float most = -std::numeric_limits<float>::infinity();
    std::uint32_t best = 0;
    for (const auto& [vertex, triangle] : uses_[number]) {
      const float along = glm::dot(normals_[triangle], normal);
      if (along > most) most = along, best = vertex;
    }
    return best;
  }

 private:
  struct use {
    std::uint32_t vertex = 0, triangle = 0;
  };
  std::vector<std::vector<use>> uses_;
  std::vector<glm::vec3> normals_;  // by triangle
};

// Edges between positions: how much more often triangles pass them in ascending than in descending direction.
using signed_border = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

signed_border border_of(std::span<const std::uint32_t> indices, const group_mesh& group) {
  signed_border border;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::uint32_t a = group.places[indices[i]];
    const std::uint32_t b = group.places[indices[i % 3 == 2 ? i - 2 : i + 1]];
    if (a != b) border[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  std::erase_if(border, [](const auto& edge) { return edge.second == 0; });
  return border;
}

using local_triangle = std::array<std::uint32_t, 3>;

std::vector<local_triangle> sorted_triangles(std::span<const std::uint32_t> indices) {
  std::vector<local_triangle> out;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    local_triangle t = {indices[i], indices[i + 1], indices[i + 2]};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.push_back(t);
  }
  std::sort(out.begin(), out.end());
  return out;
}

double distance_between(const group_mesh& group, std::span<const std::uint32_t> coarse) {
  const std::vector<local_triangle> before = sorted_triangles(group.indices), after = sorted_triangles(coarse);
  std::vector<local_triangle> only_before, only_after;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(only_before));
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(only_after));
  const auto surface = [&](const std::vector<local_triangle>& triangles) {
    std::vector<surface_triangle> out;
    for (const local_triangle& t : triangles)
      out.push_back({{group.positions[t[0]], group.positions[t[1]], group.positions[t[2]]},
                     {group.uvs[t[0]], group.uvs[t[1]], group.uvs[t[2]]}});
    return out;
  };
  return surface_distance(surface(before), surface(only_before), surface(after), surface(only_after));
}

std::vector<std::vector<std::uint32_t>> split(const group_mesh& group, const corner_choice& corners,
                                              std::span<const std::uint32_t> indices) {
  const std::size_t room = meshopt_buildMeshletsBound(indices.size(), most_vertices_of_cluster, most_cluster_triangles);
  std::vector<meshopt_Meshlet> meshlets(room);
  std::vector<unsigned> vertices(room * most_vertices_of_cluster);
  std::vector<unsigned char> local(room * most_cluster_triangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), local.data(), indices.data(), indices.size(),
                                        &group.positions[0].x, group.positions.size(), sizeof group.positions[0],
                                        most_vertices_of_cluster, most_cluster_triangles, 0.0f));
  std::vector<std::vector<std::uint32_t>> out;
  for (const meshopt_Meshlet& m : meshlets) {
    std::vector<std::uint32_t>& cluster = out.emplace_back();
    for (std::size_t t = 0; t < m.triangle_count; ++t) {
      local_triangle numbers;
      for (std::size_t k = 0; k < 3; ++k) numbers[k] = vertices[m.vertex_offset + local[m.triangle_offset + 3 * t + k]];
      const glm::vec3 normal = normal_of_triangle(group, numbers.data());
      for (const std::uint32_t number : numbers) cluster.push_back(corners.vertex(number, normal));
    }
  }
  return out;
}

}  // namespace

std::optional<simplified_group> simplify_group(const geometry& mesh, std::span<const std::uint32_t> indices,
                                               std::span<const std::uint32_t> positions,
                                               std::span<const std::uint8_t> locked) {
  const group_mesh group = compact(mesh, indices, positions, locked);
  std::vector<std::uint32_t> coarse(indices.size());
  coarse.resize(meshopt_simplify(coarse.data(), group.indices.data(), group.indices.size(), &group.positions[0].x,
                                 group.positions.size(), sizeof group.positions[0], indices.size() / 6 * 3,
                                 farthest_collapse, meshopt_SimplifyLockBorder, nullptr));
  const double most = most_of_triangles * static_cast<double>(indices.size());
  if (coarse.empty() || static_cast<double>(coarse.size()) > most) return std::nullopt;
  if (border_of(group.indices, group) != border_of(coarse, group)) return std::nullopt;
  const double error = distance_between(group, coarse);
  if (!std::isfinite(error)) return std::nullopt;
  return simplified_group{split(group, corner_choice(group, indices), coarse), error};
}

}  // namespace sightcell::scene
