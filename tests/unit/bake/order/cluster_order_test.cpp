#include "order/cluster_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "sightcell/base/error.h"
#include "sightcell/format/set_reader.h"
#include "unit/bake/stored_file.h"
#include "unit/format/cluster_samples.h"

namespace sightcell::bake {
namespace {

using test::sample_contents;

// The polygons of each cluster, whatever their numbers.
std::set<std::set<std::uint32_t>> members_of(const cluster_numbers& clusters) {
  std::map<std::uint32_t, std::set<std::uint32_t>> members;
  for (std::uint32_t polygon = 0; polygon < clusters.size(); ++polygon) members[clusters[polygon]].insert(polygon);
  std::set<std::set<std::uint32_t>> all;
  for (auto& [number, own] : members) all.insert(std::move(own));
  return all;
}

// Gives some contents a new order, and returns the bytes of the file.
std::vector<std::byte> ordered(sample_contents& contents, const cluster_numbers& clusters) {
  order_clusters_of(contents, polygon_order_kind::per_mesh, clusters,
                    [&](std::uint32_t cell, std::vector<std::uint32_t>& set) { set = contents.sets[cell]; });
  return contents.encode();
}

std::uint64_t runs_of(const std::vector<std::byte>& bytes) {
  format::reader file;
  format::set_reader sets;
  format::row_statistics sums;
  EXPECT_EQ(format::reader::open(bytes, file), format::status::ok);
  EXPECT_EQ(sets.open(file), format::status::ok);
  EXPECT_EQ(sets.statistics(sums), format::status::ok);
  return sums.runs;
}

void expect_order(sample_contents contents) {
  test::put_in_clusters(contents, 5, 20);
  const std::uint64_t before = runs_of(contents.encode());
  const cluster_numbers clusters = clusters_of_file(contents);
  const auto expected = members_of(clusters);
  const std::vector<format::draw_record> draws = contents.draws;
  auto bytes = ordered(contents, clusters);
  EXPECT_LT(runs_of(bytes), before) << "clusters that are visible together are stored together";
  test::stored_file file(bytes);
  for (std::uint32_t cell = 0; cell < contents.sets.size(); ++cell) EXPECT_EQ(file.set(cell), contents.sets[cell]);
  EXPECT_EQ(members_of(clusters_of_file(contents)), expected);
  // Each cluster is in source order.
  for (std::size_t order = 0; order < contents.orders.size(); ++order) {
    auto polygon = contents.orders[order].begin();
    for (const std::uint32_t count : contents.clusters[order]) {
      EXPECT_TRUE(std::is_sorted(polygon, polygon + count));
      polygon += count;
    }
  }
  ASSERT_EQ(contents.draws.size(), draws.size());
  for (const format::draw_record& d : draws) {
    const auto same = std::find_if(contents.draws.begin(), contents.draws.end(),
                                   [&](const auto& other) { return other.host_tag == d.host_tag; });
    ASSERT_NE(same, contents.draws.end());
    EXPECT_TRUE(same->mesh == d.mesh && same->primitive == d.primitive && same->first_source == d.first_source &&
                same->polygon_count == d.polygon_count);
  }
}

TEST(cluster_order, instanced) {
  sample_contents contents = test::random_contents(51, {.polygons = 2000, .draws = 12, .cells = 80});
  test::put_in_order(contents, 3);
  expect_order(contents);
}

TEST(cluster_order, merged) {
  sample_contents contents = test::random_contents(52, {.polygons = 2000, .draws = 12, .cells = 80});
  test::put_in_groups(contents, 4);
  test::put_in_clusters(contents, 5, 20);
  const auto bytes_before = contents.encode();
  format::reader before;
  ASSERT_EQ(format::reader::open(bytes_before, before), format::status::ok);
  auto bytes = ordered(contents, clusters_of_file(contents));
  test::stored_file file(bytes);
  EXPECT_GT(file.reader().cluster_count(), before.cluster_count()) << "clusters of several draws are divided";
  for (std::uint32_t cell = 0; cell < contents.sets.size(); ++cell) EXPECT_EQ(file.set(cell), contents.sets[cell]);
}

// Two instances of a mesh with the same clusters share an order; a third with others does not.
TEST(cluster_order, instances_share_clusters) {
  sample_contents contents;
  contents.facts.polygon_count = 12;
  for (std::uint32_t i = 0; i < 3; ++i)
    contents.draws.push_back({.node = i, .mesh = 4, .first_source = 4 * i, .polygon_count = 4, .first_stored = 4 * i});
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  contents.sets = {{0, 2, 4, 6, 8}, {1, 3, 5, 7, 9, 10, 11}};
  auto bytes = ordered(contents, {0, 1, 0, 1, 2, 3, 2, 3, 4, 5, 5, 5});
  test::stored_file file(bytes);
  EXPECT_EQ(contents.orders.size(), 2u);
  EXPECT_EQ(file.reader().cluster_count(), 6u);
  for (std::uint32_t cell = 0; cell < 2; ++cell) EXPECT_EQ(file.set(cell), contents.sets[cell]);
  // A cluster is in a set if any of its polygons is.
  contents.sets = {{2, 9}, {}};
  bytes = contents.encode();
  test::stored_file some(bytes);
  EXPECT_EQ(some.set(0), (std::vector<std::uint32_t>{0, 2, 9, 10, 11}));
}

TEST(cluster_order, of_the_host) {
  scene::scene s;
  s.geometries.resize(2);
  s.geometries[0].indices.assign(9, 0);
  s.geometries[0].positions.assign(1, glm::vec3(0));
  s.geometries[0].clusters = {9, 2, 9};
  s.geometries[1] = s.geometries[0];
  s.geometries[1].indices.assign(3 * 257, 0);
  s.geometries[1].clusters.assign(257, 7);
  s.materials.resize(1);
  for (std::uint32_t i = 0; i < 2; ++i)
    s.draws.push_back({.node = i, .material = 0, .to_world = glm::dmat4(1.0), .tags = {}});
  scene::finish(s);
  EXPECT_EQ(clusters_of_scene(s), (cluster_numbers{1, 0, 1, 3, 2, 3}));
  s.draws[1].geometry = 1;
  s.draws[1].mesh = 1;
  scene::finish(s);
  EXPECT_THROW((void)clusters_of_scene(s), error) << "more than 256 triangles";
}

}  // namespace
}  // namespace sightcell::bake
