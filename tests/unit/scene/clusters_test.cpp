#include "sightcell/scene/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

namespace {

using namespace sightcell::scene;

// A flat grid of 2 * side * side triangles, row by row.
geometry grid_mesh(std::uint32_t side) {
  geometry mesh;
  for (std::uint32_t z = 0; z <= side; ++z)
    for (std::uint32_t x = 0; x <= side; ++x)
      mesh.positions.push_back({static_cast<float>(x), 0.0f, static_cast<float>(z)});
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = z * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
    }
  }
  return mesh;
}

// Its triangles in an order that jumps over the whole mesh.
geometry scattered(const geometry& mesh) {
  geometry out = mesh;
  const std::size_t triangles = mesh.indices.size() / 3;
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::size_t from = 619 * t % triangles;  // a prime that divides none of the numbers here
    for (std::size_t k = 0; k < 3; ++k) out.indices[3 * t + k] = mesh.indices[3 * from + k];
  }
  return out;
}

std::vector<std::uint32_t> sizes_of(const mesh_clusters& clusters) {
  std::vector<std::uint32_t> sizes(clusters.count);
  for (const std::uint32_t cluster : clusters.of_triangle) ++sizes.at(cluster);
  return sizes;
}

bool ascend(const std::vector<std::uint32_t>& numbers) {
  return std::is_sorted(numbers.begin(), numbers.end());
}

TEST(clusters, of_a_compact_index_order_follow_it) {
  const mesh_clusters one = clusters_of(grid_mesh(8));
  EXPECT_EQ(one.count, 1u);
  EXPECT_EQ(one.of_triangle, std::vector<std::uint32_t>(128, 0));
  const mesh_clusters none = clusters_of({});
  EXPECT_EQ(none.count, 0u);
  geometry line = grid_mesh(1);
  for (std::uint32_t i = 0; i < 300; ++i) line.indices.insert(line.indices.end(), {0, 1, 2});
  const mesh_clusters equal = clusters_of(line);  // 302 triangles in one place
  EXPECT_TRUE(ascend(equal.of_triangle));
  EXPECT_EQ(sizes_of(equal), (std::vector<std::uint32_t>{101, 101, 100}));
}

TEST(clusters, of_a_scattered_index_order_are_compact) {
  const geometry mesh = scattered(grid_mesh(40));  // 3,200 triangles
  const mesh_clusters made = clusters_of(mesh);
  EXPECT_FALSE(ascend(made.of_triangle));
  const auto sizes = sizes_of(made);
  EXPECT_EQ(std::accumulate(sizes.begin(), sizes.end(), 0u), 3200u);
  for (const std::uint32_t size : sizes) EXPECT_TRUE(size >= 1 && size <= most_cluster_triangles) << size;
  EXPECT_LT(made.count, 50u);
  std::vector<std::set<std::uint32_t>> vertices(made.count);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) vertices[made.of_triangle[i / 3]].insert(mesh.indices[i]);
  for (const auto& some : vertices) EXPECT_LE(some.size(), 128u);
  EXPECT_EQ(clusters_of(mesh).of_triangle, made.of_triangle);
}

TEST(clusters, positions_that_are_not_finite_leave_the_index_order) {
  geometry mesh = scattered(grid_mesh(40));
  mesh.positions[5].y = std::numeric_limits<float>::quiet_NaN();
  const mesh_clusters made = clusters_of(mesh);
  EXPECT_TRUE(ascend(made.of_triangle));
  EXPECT_EQ(made.count, 25u);
}

TEST(clusters, equal_triangles_are_each_in_one) {
  geometry mesh = scattered(grid_mesh(20));
  mesh.indices.insert(mesh.indices.end(), mesh.indices.begin(), mesh.indices.begin() + 600);
  const auto sizes = sizes_of(clusters_of(mesh));
  EXPECT_EQ(std::accumulate(sizes.begin(), sizes.end(), 0u), 1000u);
  EXPECT_EQ(std::count(sizes.begin(), sizes.end(), 0u), 0);
}

TEST(clusters, of_the_host_get_numbers_without_gaps) {
  geometry mesh = grid_mesh(2);
  mesh.clusters = {70, 3, 3, 70, 0xFFFFFFFFu, 3, 70, 9};
  const mesh_clusters made = clusters_of(mesh);
  EXPECT_EQ(made.count, 4u);
  EXPECT_EQ(made.of_triangle, (std::vector<std::uint32_t>{2, 0, 0, 2, 3, 0, 2, 1}));
}

}  // namespace
