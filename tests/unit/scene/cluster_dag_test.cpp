// Levels of detail in clusters: closed meshes, whose cuts must be closed too.
#include "sightcell/scene/cluster_dag.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "sightcell/scene/clusters.h"
#include "surface_distance.h"

namespace sightcell::scene {
namespace {

using place = std::array<float, 3>;

// A closed torus with waves. seam: where it closes, vertices are there twice, as for texture coordinates.
geometry wavy_torus(std::uint32_t around, std::uint32_t across, bool seam) {
  geometry mesh;
  const std::uint32_t columns = around + (seam ? 1 : 0);
  for (std::uint32_t i = 0; i < columns; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * (i % around) / around, v = 2.0 * std::numbers::pi * j / across;
      const double r = 1.0 + 0.05 * std::sin(9.0 * u) * std::cos(4.0 * v), x = 3.0 + r * std::cos(v);
      mesh.positions.emplace_back(x * std::cos(u), r * std::sin(v), x * std::sin(u));
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t next = (i + 1) % columns, up = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = next * across + j, c = i * across + up, d = next * across + up;
      for (const std::uint32_t corner : {a, c, b, b, c, d}) mesh.indices.push_back(corner);
    }
  }
  return mesh;
}

place place_of(const geometry& mesh, std::uint32_t vertex) {
  const glm::vec3& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

using refined = std::function<bool(std::uint32_t)>;  // whether what replaces a group is fine enough

std::vector<std::uint32_t> cut_of(const cluster_dag& dag, const refined& fine) {
  std::vector<std::uint32_t> cut;
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    const dag_cluster& cluster = dag.clusters[c];
    const bool own = cluster.made_by == no_index || fine(cluster.made_by);
    if (own && (cluster.group == no_index || !fine(cluster.group))) cut.push_back(c);
  }
  return cut;
}

// As a host decides for a viewpoint.
refined seen_from(const cluster_dag& dag, const glm::vec3& eye, float error_at_1) {
  return [&dag, eye, error_at_1](std::uint32_t number) {
    const dag_group& g = dag.groups[number];
    return g.error <= error_at_1 * std::max(0.0f, glm::distance(eye, g.bounds.center) - g.bounds.radius);
  };
}

std::vector<std::uint32_t> triangles_of(const cluster_dag& dag, const std::vector<std::uint32_t>& cut) {
  std::vector<std::uint32_t> indices;
  for (const std::uint32_t c : cut) {
    const auto from = dag.indices.begin() + std::ptrdiff_t{3} * dag.clusters[c].first_triangle;
    indices.insert(indices.end(), from, from + std::ptrdiff_t{3} * dag.clusters[c].triangle_count);
  }
  return indices;
}

// Edges that triangles do not pass as often in one direction as in the other.
std::size_t open_edges(const geometry& mesh, const std::vector<std::uint32_t>& indices) {
  std::map<std::pair<place, place>, int> passes;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const place a = place_of(mesh, indices[i]), b = place_of(mesh, indices[i % 3 == 2 ? i - 2 : i + 1]);
    if (a != b) passes[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  return static_cast<std::size_t>(
      std::count_if(passes.begin(), passes.end(), [](const auto& edge) { return edge.second != 0; }));
}

double volume_of(const geometry& mesh, const std::vector<std::uint32_t>& indices) {
  double volume = 0.0;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[indices[i]]), b(mesh.positions[indices[i + 1]]),
        c(mesh.positions[indices[i + 2]]);
    volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return volume;
}

double area_of(const geometry& mesh, const std::vector<std::uint32_t>& indices) {
  double area = 0.0;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[indices[i]]), b(mesh.positions[indices[i + 1]]),
        c(mesh.positions[indices[i + 2]]);
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return area;
}

// The greatest error of a cluster of a cut.
double error_of(const cluster_dag& dag, const std::vector<std::uint32_t>& cut) {
  float most = 0.0f;
  for (const std::uint32_t c : cut)
    if (dag.clusters[c].made_by != no_index) most = std::max(most, dag.groups[dag.clusters[c].made_by].error);
  return static_cast<double>(most);
}

std::vector<surface_triangle> surface_of(const geometry& mesh, const std::vector<std::uint32_t>& indices) {
  std::vector<surface_triangle> out;
  for (std::size_t i = 0; i < indices.size(); i += 3)
    out.push_back({{mesh.positions[indices[i]], mesh.positions[indices[i + 1]], mesh.positions[indices[i + 2]]}, {}});
  return out;
}

TEST(cluster_dag, is_made_of_the_clusters_of_the_mesh) {
  const geometry mesh = wavy_torus(96, 48, true);
  const cluster_dag dag = build_cluster_dag(mesh);
  const mesh_clusters leaves = clusters_of(mesh);
  EXPECT_EQ(dag.of_triangle, leaves.of_triangle);
  EXPECT_EQ(dag.leaf_count, leaves.count);
  const std::vector<std::uint32_t> cut = cut_of(dag, [](std::uint32_t) { return false; });
  ASSERT_EQ(cut.size(), leaves.count);
  EXPECT_EQ(cut.back(), leaves.count - 1) << "nothing but leaves";
  EXPECT_EQ(triangles_of(dag, cut).size(), mesh.indices.size());
  std::vector<std::uint32_t> used(leaves.count, 0);
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const std::uint32_t leaf = dag.of_triangle[t];
    const std::size_t at = dag.clusters[leaf].first_triangle + used[leaf]++;
    EXPECT_TRUE(std::equal(&mesh.indices[3 * t], &mesh.indices[3 * t] + 3, &dag.indices[3 * at])) << t;
  }
}

TEST(cluster_dag, cuts_of_a_closed_mesh_are_closed) {
  for (const bool seam : {false, true}) {
    const geometry mesh = wavy_torus(96, 48, seam);
    const cluster_dag dag = build_cluster_dag(mesh);
    const double volume = volume_of(mesh, mesh.indices), area = area_of(mesh, mesh.indices);
    std::mt19937 random(7);
    std::size_t fewest = mesh.indices.size(), mixed = 0;
    for (int i = 0; i < 30; ++i) {
      const auto number = [&](float scale) { return scale * (static_cast<float>(random() % 2001) / 1000.0f - 1.0f); };
      const glm::vec3 eye{number(9.0f), number(5.0f), number(9.0f)};
      const float error = std::pow(10.0f, number(1.5f) - 2.0f);
      const std::vector<std::uint32_t> cut = cut_of(dag, seen_from(dag, eye, error));
      const std::vector<std::uint32_t> indices = triangles_of(dag, cut);
      EXPECT_EQ(open_edges(mesh, indices), 0u) << "error " << error;
      EXPECT_NEAR(volume_of(mesh, indices), volume, area * error_of(dag, cut) + 1e-3);
      fewest = std::min(fewest, indices.size());
      mixed += cut.front() < dag.leaf_count && cut.back() >= dag.leaf_count;
    }
    EXPECT_LT(fewest, mesh.indices.size() / 8);
    EXPECT_GT(mixed, 5u) << "cuts with leaves and coarse clusters";
    // A cluster that is missing opens its cut.
    std::vector<std::uint32_t> cut = cut_of(dag, seen_from(dag, {6.0f, 0.0f, 0.0f}, 0.01f));
    cut.pop_back();
    EXPECT_GT(open_edges(mesh, triangles_of(dag, cut)), 0u);
  }
}

TEST(cluster_dag, errors_and_spheres_grow_from_level_to_level) {
  const geometry mesh = wavy_torus(96, 48, true);
  const cluster_dag dag = build_cluster_dag(mesh);
  ASSERT_GT(dag.groups.size(), 20u);
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    const dag_cluster& cluster = dag.clusters[c];
    EXPECT_GE(cluster.triangle_count, 1u);
    EXPECT_LE(cluster.triangle_count, most_cluster_triangles);
    EXPECT_EQ(cluster.made_by == no_index, c < dag.leaf_count);
    if (cluster.group == no_index) continue;
    const dag_group& above = dag.groups[cluster.group];
    EXPECT_GT(above.first_cluster, c) << "clusters follow those below them";
    for (const std::uint32_t vertex : triangles_of(dag, {c}))
      EXPECT_LE(glm::distance(mesh.positions[vertex], above.bounds.center), above.bounds.radius);
    if (cluster.made_by == no_index) continue;
    const dag_group& below = dag.groups[cluster.made_by];
    EXPECT_GT(cluster.group, cluster.made_by);
    EXPECT_GT(above.level, below.level);
    EXPECT_GE(above.error, below.error);
    EXPECT_LE(glm::distance(below.bounds.center, above.bounds.center) + below.bounds.radius, above.bounds.radius);
  }
  for (const dag_group& group : dag.groups) EXPECT_LE(group.bounds.radius, 7.0f) << "the mesh has 4.05";
  // The error of the coarsest levels is a bound of the distance to the mesh.
  const std::vector<std::uint32_t> coarsest = cut_of(dag, [](std::uint32_t) { return true; });
  const std::vector<surface_triangle> all = surface_of(mesh, mesh.indices);
  float most = 0.0f;
  for (const std::uint32_t c : coarsest) {
    const float error = dag.groups.at(dag.clusters[c].made_by).error;
    const std::vector<surface_triangle> part = surface_of(mesh, triangles_of(dag, {c}));
    EXPECT_LE(surface_distance(all, {}, part, part), 1.01 * static_cast<double>(error));
    most = std::max(most, error);
  }
  EXPECT_LE(surface_distance(all, all, surface_of(mesh, triangles_of(dag, coarsest)), {}),
            1.01 * static_cast<double>(most));
}

TEST(cluster_dag, of_the_same_mesh_is_the_same) {
  const geometry mesh = wavy_torus(40, 30, true);
  const cluster_dag dag = build_cluster_dag(mesh);
  EXPECT_GT(dag.groups.size(), 3u);
  EXPECT_EQ(build_cluster_dag(mesh), dag);
}

TEST(cluster_dag, keeps_the_clusters_of_the_host_and_what_cannot_be_simplified) {
  geometry mesh = wavy_torus(8, 8, false);
  for (std::uint32_t t = 0; t < 128; ++t) mesh.clusters.push_back(t / 16 * 5);
  const cluster_dag of_host = build_cluster_dag(mesh);
  EXPECT_EQ(of_host.leaf_count, 8u);
  EXPECT_EQ(of_host.of_triangle[127], 7u);
  EXPECT_EQ(build_cluster_dag(mesh, false).clusters.size(), 8u);
  mesh.positions[5].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(build_cluster_dag(mesh).groups.empty());
  EXPECT_TRUE(build_cluster_dag({}).clusters.empty());
  geometry apart;  // 400 triangles without neighbors: every corner is at a border
  for (std::uint32_t t = 0; t < 400; ++t) {
    const auto x = static_cast<float>(2 * t);
    for (const glm::vec3& p : {glm::vec3{x, 0, 0}, glm::vec3{x + 1, 0, 0}, glm::vec3{x, 1, 0}}) {
      apart.indices.push_back(static_cast<std::uint32_t>(apart.positions.size()));
      apart.positions.push_back(p);
    }
  }
  EXPECT_TRUE(build_cluster_dag(apart).groups.empty());
}

// A flat grid of 30 x 30 squares.
geometry flat_grid() {
  geometry mesh;
  for (std::uint32_t z = 0; z <= 30; ++z)
    for (std::uint32_t x = 0; x <= 30; ++x) {
      const float a = 0.7f * static_cast<float>(x), b = 0.9f * static_cast<float>(z);
      mesh.positions.emplace_back(a, 0.3f * a + 0.11f * b, b);
    }
  for (std::uint32_t z = 0; z < 30; ++z)
    for (std::uint32_t x = 0; x < 30; ++x) {
      const std::uint32_t a = 31 * z + x;
      mesh.indices.insert(mesh.indices.end(), {a, a + 31, a + 1, a + 1, a + 31, a + 32});
    }
  return mesh;
}

TEST(cluster_dag, of_a_flat_surface_has_no_error) {
  geometry mesh = flat_grid();
  for (const bool textured : {false, true}) {
    if (textured)
      for (const glm::vec3& p : mesh.positions) mesh.uvs.emplace_back(0.25f * p.x + 0.1f * p.z, 0.5f * p.z - 3.0f);
    const cluster_dag dag = build_cluster_dag(mesh);
    ASSERT_GT(dag.groups.size(), 1u);
    for (const dag_group& group : dag.groups) EXPECT_EQ(group.error, 0.0f);
  }
}

TEST(cluster_dag, of_a_texture_that_is_not_even_has_an_error) {
  geometry mesh = flat_grid();
  const auto u_at = [](double x) { return x + 0.4 * std::sin(1.3 * x); };  // grows by 0.48 to 1.52 per meter
  for (const glm::vec3& p : mesh.positions)
    mesh.uvs.emplace_back(static_cast<float>(u_at(static_cast<double>(p.x))), p.z);
  const cluster_dag dag = build_cluster_dag(mesh);
  ASSERT_GT(dag.groups.size(), 1u);
  double greatest = 0.0;
  for (const dag_cluster& cluster : dag.clusters) {
    if (cluster.made_by == no_index) continue;
    const double error = static_cast<double>(dag.groups[cluster.made_by].error);
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      const std::uint32_t* corner = &dag.indices[std::size_t{3} * (cluster.first_triangle + t)];
      double x = 0.0, u = 0.0;  // of its center
      for (int k = 0; k < 3; ++k) {
        x += static_cast<double>(mesh.positions[corner[k]].x) / 3.0;
        u += static_cast<double>(mesh.uvs[corner[k]].x) / 3.0;
      }
      // The texture is piecewise even in the mesh: each piece has bends of up to 0.4 * 1.69 * 0.7 * 0.7 / 8.
      const double moved = (std::abs(u - u_at(x)) - 0.042) / 1.52;
      EXPECT_LE(moved, error);
      greatest = std::max(greatest, moved);
    }
  }
  EXPECT_GT(greatest, 0.05);
}

TEST(cluster_dag, measures_how_far_textures_move) {
  using uv = std::array<glm::vec2, 3>;
  const std::array<glm::vec3, 3> corners{glm::vec3{0, 0, 0}, glm::vec3{4, 0, 0}, glm::vec3{0, 4, 0}};
  const auto between = [&](const uv& a, const uv& b) {
    const std::vector<surface_triangle> from{{corners, a}}, to{{corners, b}};
    return surface_distance(from, {}, to, to);
  };
  const uv even{glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{0, 2}};  // 4 and 2 m for a texture
  EXPECT_DOUBLE_EQ(between(even, even), 0.0);
  EXPECT_NEAR(between(even, {glm::vec2{0.25, 0}, glm::vec2{1.25, 0}, glm::vec2{0.25, 2}}), 1.0, 1e-6);
  EXPECT_NEAR(between(even, {glm::vec2{0, 0.25}, glm::vec2{1, 0.25}, glm::vec2{0, 2.25}}), 0.5, 1e-6);
  const uv line{glm::vec2{0, 0}, glm::vec2{1, 1}, glm::vec2{0, 0}};  // along one line
  EXPECT_DOUBLE_EQ(between(line, line), 0.0);
  EXPECT_GT(between(line, even), 0.5);
  const uv one{glm::vec2{0.3, 0.3}, glm::vec2{0.3, 0.3}, glm::vec2{0.3, 0.3}};
  EXPECT_DOUBLE_EQ(between(one, one), 0.0);
  EXPECT_TRUE(std::isinf(between(one, even)));
}

TEST(cluster_dag, is_for_opaque_occluders_that_stay) {
  scene s;
  s.materials.resize(2);
  s.materials[1].alpha = alpha_mode::mask;
  const auto with = [&](const std::function<void(draw&)>& change) {
    draw d;
    change(d);
    return may_have_levels(s, d);
  };
  EXPECT_TRUE(with([](draw&) {}));
  EXPECT_TRUE(with([](draw& d) { d.material = 0; }));
  EXPECT_FALSE(with([](draw& d) { d.material = 1; }));
  EXPECT_FALSE(with([](draw& d) { d.tags.occluder = false; }));
  EXPECT_FALSE(with([](draw& d) { d.tags.animated = true; }));
  EXPECT_FALSE(with([](draw& d) { d.tags.group = 0; }));
  EXPECT_FALSE(with([](draw& d) { d.moves = true; }));
  EXPECT_FALSE(with([](draw& d) { d.lod_object = 0; }));
}

TEST(cluster_dag, measures_surfaces_both_ways) {
  const std::vector<surface_triangle> flat = {{{glm::vec3{0, 0, 0}, glm::vec3{4, 0, 0}, glm::vec3{0, 4, 0}}, {}}};
  const std::vector<surface_triangle> peak = {{{glm::vec3{0, 0, 0}, glm::vec3{4, 0, 0}, glm::vec3{1, 1, 3}}, {}}};
  EXPECT_DOUBLE_EQ(surface_distance(flat, flat, flat, flat), 0.0);
  EXPECT_DOUBLE_EQ(surface_distance(flat, {}, peak, peak), 3.0);
  const std::vector<surface_triangle> line = {{{glm::vec3{0, 0, 0}, glm::vec3{0, 0, 0}, glm::vec3{4, 0, 0}}, {}}};
  EXPECT_DOUBLE_EQ(surface_distance(line, {}, flat, flat), 4.0);
}

}  // namespace
}  // namespace sightcell::scene
