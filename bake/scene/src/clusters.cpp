#include "sightcell/scene/clusters.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace sightcell::scene {
namespace {

constexpr std::size_t most_cluster_vertices = 128;
// How much larger boxes around consecutive triangles may be, as a factor of their surface.
constexpr double index_order_allowance = 1.1;

using triangle_corners = std::array<std::uint32_t, 3>;

triangle_corners corners_of(const geometry& mesh, std::size_t triangle) {
  return {mesh.indices[3 * triangle], mesh.indices[3 * triangle + 1], mesh.indices[3 * triangle + 2]};
}

// Clusters of nearly equal size.
mesh_clusters in_index_order(std::size_t triangles) {
  mesh_clusters out;
  out.count = static_cast<std::uint32_t>((triangles + most_cluster_triangles - 1) / most_cluster_triangles);
  for (std::size_t t = 0; t < triangles; ++t)
    out.of_triangle.push_back(static_cast<std::uint32_t>(t * out.count / triangles));
  return out;
}

mesh_clusters by_meshoptimizer(const geometry& mesh) {
  const std::size_t room =
      meshopt_buildMeshletsBound(mesh.indices.size(), most_cluster_vertices, most_cluster_triangles);
  std::vector<meshopt_Meshlet> meshlets(room);
  std::vector<unsigned> vertices(room * most_cluster_vertices);
  std::vector<unsigned char> local(room * most_cluster_triangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), local.data(), mesh.indices.data(),
                                        mesh.indices.size(), &mesh.positions[0].x, mesh.positions.size(),
                                        sizeof mesh.positions[0], most_cluster_vertices, most_cluster_triangles, 0.0f));
  // meshoptimizer returns the corners of triangles without their numbers.
  std::map<triangle_corners, std::vector<std::uint32_t>> numbers;
  const auto triangles = static_cast<std::uint32_t>(mesh.indices.size() / 3);
  for (std::uint32_t t = triangles; t-- > 0;) numbers[corners_of(mesh, t)].push_back(t);
  mesh_clusters out{std::vector<std::uint32_t>(triangles), static_cast<std::uint32_t>(meshlets.size())};
  for (std::uint32_t m = 0; m < meshlets.size(); ++m) {
    for (std::size_t t = 0; t < meshlets[m].triangle_count; ++t) {
      triangle_corners corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = vertices[meshlets[m].vertex_offset + local[meshlets[m].triangle_offset + 3 * t + k]];
      std::vector<std::uint32_t>& same = numbers.at(corners);
      out.of_triangle[same.back()] = m;
      same.pop_back();
    }
  }
  return out;
}

// The surface of the boxes around all clusters together.
double surface_of(const geometry& mesh, const mesh_clusters& clusters) {
  struct bounds {
    glm::vec3 min{std::numeric_limits<float>::max()}, max{std::numeric_limits<float>::lowest()};
  };
  std::vector<bounds> boxes(clusters.count);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    bounds& b = boxes[clusters.of_triangle[i / 3]];
    b.min = glm::min(b.min, mesh.positions[mesh.indices[i]]);
    b.max = glm::max(b.max, mesh.positions[mesh.indices[i]]);
  }
  double sum = 0.0;
  for (const bounds& b : boxes) {
    const glm::dvec3 size = glm::dvec3(b.max) - glm::dvec3(b.min);
    sum += size.x * size.y + size.y * size.z + size.z * size.x;
  }
  return sum;
}

// Numbers without gaps, in ascending order of those of the host.
mesh_clusters by_host(const std::vector<std::uint32_t>& given) {
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (const std::uint32_t cluster : given) numbers.emplace(cluster, 0);
  mesh_clusters out;
  for (auto& [cluster, number] : numbers) number = out.count++;
  for (const std::uint32_t cluster : given) out.of_triangle.push_back(numbers.at(cluster));
  return out;
}

}  // namespace

mesh_clusters clusters_of(const geometry& mesh) {
  if (!mesh.clusters.empty()) return by_host(mesh.clusters);
  mesh_clusters in_order = in_index_order(mesh.indices.size() / 3);
  const auto is_finite = [](const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  if (in_order.count <= 1 || !std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite)) return in_order;
  mesh_clusters made = by_meshoptimizer(mesh);
  const double most = index_order_allowance * surface_of(mesh, made);
  return surface_of(mesh, in_order) <= most ? in_order : made;
}

}  // namespace sightcell::scene
