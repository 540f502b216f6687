// Triangles of a primitive, matched with those of importers that reorder, split, renumber, drop and turn them.
#include "sightcell/hosts/match.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "loaded_file.h"
#include "sightcell/clusters.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::hosts;
using namespace sightcell::test;

struct mesh {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  [[nodiscard]] triangle_list view() const { return {.positions = positions, .indices = indices}; }
};

// A grid of n x n quads; triangle t is found again by its corners.
mesh grid(std::uint32_t n) {
  mesh m;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      m.positions.insert(m.positions.end(), {0.1f * static_cast<float>(x), 0.0f, 0.3f * static_cast<float>(y)});
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = y * (n + 1) + x;
      m.indices.insert(m.indices.end(), {v, v + 1, v + n + 1, v + 1, v + n + 2, v + n + 1});
    }
  }
  return m;
}

// The triangles of a mesh in a random order, each with vertices of its own and beginning at any corner.
mesh reordered(const mesh& from, std::uint32_t seed, std::vector<std::uint32_t>& number) {
  random_source random(seed);
  number = all_polygons(static_cast<std::uint32_t>(from.indices.size() / 3));
  shuffle(random, number);
  mesh m;
  for (const std::uint32_t t : number) {
    const std::uint32_t begin = random.below(3);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = from.indices[3 * t + (begin + k) % 3];
      m.indices.push_back(static_cast<std::uint32_t>(m.positions.size() / 3));
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const float value = from.positions[3 * v + axis];
        m.positions.push_back(value == 0.0f ? -0.0f : value);  // equal to +0
      }
    }
  }
  return m;
}

TEST(match, an_importer_that_reorders) {
  const mesh source = grid(12);
  std::vector<std::uint32_t> number;
  const mesh host = reordered(source, 1, number);
  const std::array parts{host.view()};
  const triangle_match m = match_triangles(source.view(), parts);
  EXPECT_EQ(m.missing + m.extra + m.turned, 0u);
  EXPECT_EQ(m.first_missing, host_triangle::none);
  EXPECT_FALSE(m.first_extra.exists());
  for (std::uint32_t t = 0; t < number.size(); ++t) EXPECT_EQ(m.of_source[number[t]], (host_triangle{0, t}));
}

TEST(match, an_importer_that_splits_drops_and_adds) {
  const mesh source = grid(6);  // 72 triangles
  std::vector<std::uint32_t> number;
  const mesh host = reordered(source, 2, number);
  mesh first = host, second = host;
  first.indices.resize(3 * 30);
  second.indices.assign(host.indices.begin() + 3 * 30, host.indices.end() - 3 * 2);  // two triangles are lost
  second.indices.insert(second.indices.end(), {0, 1, 5});                            // and one is of something else
  second.indices.insert(second.indices.end(), {0, 1, 5000});                         // or no triangle at all
  const std::array parts{first.view(), second.view()};
  const triangle_match m = match_triangles(source.view(), parts);
  EXPECT_EQ(m.missing, 2u);
  EXPECT_EQ(m.first_missing, std::min(number[70], number[71]));
  EXPECT_EQ(m.extra, 2u);
  EXPECT_EQ(m.first_extra, (host_triangle{1, 40}));
  for (std::uint32_t t = 0; t < 70; ++t) {
    EXPECT_EQ(m.of_source[number[t]], t < 30 ? (host_triangle{0, t}) : (host_triangle{1, t - 30}));
  }
}

// A wall that is visible from both sides is two triangles with the same corners.
TEST(match, both_sides_of_a_wall_are_two_triangles) {
  const mesh wall{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2, 0, 2, 1}};
  const mesh swapped{wall.positions, {2, 1, 0, 1, 2, 0}};
  const std::array parts{swapped.view()};
  const triangle_match m = match_triangles(wall.view(), parts);
  EXPECT_EQ(m.of_source, (std::vector<host_triangle>{{0, 1}, {0, 0}}));
  EXPECT_EQ(m.turned, 0u);
  const mesh turned{wall.positions, {2, 1, 0}};  // of the first alone, by an importer that turns it over
  const std::array other{turned.view()};
  const mesh front{wall.positions, {0, 1, 2}};
  const triangle_match over = match_triangles(front.view(), other);
  EXPECT_EQ(over.of_source, (std::vector<host_triangle>{{0, 0}}));
  EXPECT_EQ(over.turned, 1u);
}

TEST(match, equal_triangles_are_matched_in_order_and_strides_are_skipped) {
  const mesh source{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2, 0, 1, 2, 1, 2, 0}};
  const std::vector<float> with_normals{0, 0, 0, 9, 9, 9, 1, 0, 0, 8, 8, 8, 0, 1, 0, 7, 7, 7};
  const std::array parts{triangle_list{.positions = with_normals, .stride = 6, .indices = source.indices}};
  EXPECT_EQ(match_triangles(source.view(), parts).of_source, (std::vector<host_triangle>{{0, 0}, {0, 1}, {0, 2}}));
}

// The index buffer of each draw of a file, made from a mesh in another order, has the polygons in stored order.
TEST(match, index_buffers_are_permuted) {
  sample_contents contents = random_contents(71, {.polygons = 400, .draws = 12, .cells = 10});
  put_in_order(contents, 3);
  const loaded_file file(contents);
  std::vector<sightcell_draw> draws(contents.draws.size());
  std::vector<std::uint32_t> order(400);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_draws(file.db(), draws.data(), draws.size(), &count), SIGHTCELL_OK);
  ASSERT_EQ(sightcell_db_order(file.db(), order.data(), order.size(), &count), SIGHTCELL_OK);
  for (const sightcell_draw& d : draws) {
    mesh source = grid(20);
    source.indices.resize(3 * std::size_t{d.polygon_count});
    std::vector<std::uint32_t> number;
    const mesh host = reordered(source, d.first_source, number);
    const std::array parts{host.view()};
    triangle_match m = match_triangles(source.view(), parts);
    const auto permuted = permuted_indices(d, order, m, host.indices);
    ASSERT_EQ(permuted.size(), source.indices.size());
    const std::array again{triangle_list{.positions = host.positions, .indices = permuted}};
    const triangle_match stored = match_triangles(source.view(), again);
    for (std::uint32_t i = 0; i < d.polygon_count; ++i) {
      EXPECT_EQ(stored.of_source[order[d.first_stored + i] - d.first_source].triangle, i);
    }
    if (d.polygon_count == 0) continue;
    m.of_source[0] = {};
    const std::vector<std::uint32_t> with_a_gap = permuted_indices(d, order, m, host.indices);
    for (std::uint32_t i = 0; i < permuted.size(); ++i) {
      EXPECT_EQ(with_a_gap[i], order[d.first_stored + i / 3] == d.first_source ? 0 : permuted[i]);
    }
    m.of_source[0] = {1, 0};
    EXPECT_TRUE(permuted_indices(d, order, m, host.indices).empty()) << "another part";
    m.of_source.pop_back();
    EXPECT_TRUE(permuted_indices(d, order, m, host.indices).empty()) << "another primitive";
  }
}

// A host that keeps its order: each mesh is reordered and split in two, draws are in another order, the last triangle
// of each mesh is lost, and each first part has one that is of nothing.
class kept_order : public testing::Test {
 protected:
  void SetUp() override {
    std::size_t count = 0;
    ASSERT_EQ(sightcell_db_draws(file_.db(), draws_.data(), draws_.size(), &count), SIGHTCELL_OK);
    ASSERT_EQ(sightcell_db_order(file_.db(), stored_.data(), stored_.size(), &count), SIGHTCELL_OK);
    std::reverse(draws_.begin(), draws_.end());
    for (const sightcell_draw& d : draws_) add(d);
  }

  void add(const sightcell_draw& d) {
    mesh source = grid(20);
    source.indices.resize(3 * std::size_t{d.polygon_count});
    std::vector<std::uint32_t> number;
    const mesh host = reordered(source, d.first_source, number);
    const std::uint32_t kept = d.polygon_count == 0 ? 0 : d.polygon_count - 1, half = kept / 2;
    const auto at = [&](std::uint32_t t) { return host.indices.begin() + 3 * static_cast<std::ptrdiff_t>(t); };
    mesh first{host.positions, {at(0), at(half)}};
    const mesh second{host.positions, {at(half), at(kept)}};
    first.indices.insert(first.indices.end(), {0, 0, 0});
    if (first.positions.empty()) first.positions.assign(3, 0.0f);
    const std::array parts{first.view(), second.view()};
    matches_.push_back(match_triangles(source.view(), parts));
    firsts_.push_back({host_count_, host_count_ + half + 1});
    for (std::uint32_t t = 0; t < half; ++t) expected_.push_back(d.first_source + number[t]);
    expected_.push_back(host_order::none);
    for (std::uint32_t t = half; t < kept; ++t) expected_.push_back(d.first_source + number[t]);
    if (kept < d.polygon_count) lost_.push_back(d.first_source + number[kept]);
    host_count_ += kept + 1;
  }

  std::vector<matched_draw> matched() const {
    std::vector<matched_draw> out;
    for (std::size_t i = 0; i < draws_.size(); ++i) out.push_back({draws_[i], &matches_[i], firsts_[i]});
    return out;
  }

  static sample_contents contents() {
    sample_contents made = random_contents(72, {.polygons = 400, .draws = 12, .cells = 10});
    put_in_order(made, 3);
    return made;
  }

  loaded_file file_{contents()};
  std::vector<sightcell_draw> draws_ = std::vector<sightcell_draw>(contents().draws.size());
  std::vector<std::uint32_t> stored_ = std::vector<std::uint32_t>(400);
  std::vector<triangle_match> matches_;
  std::vector<std::array<std::uint32_t, 2>> firsts_;
  std::vector<std::uint32_t> expected_, lost_;  // by polygon of the host: its source id; source ids without one
  std::uint32_t host_count_ = 0;
};

TEST_F(kept_order, maps_polygons_both_ways) {
  const std::optional<host_order> order = order_of_host(matched(), 400, host_count_);
  ASSERT_TRUE(order);
  EXPECT_EQ(order->source_of_host, expected_);
  std::sort(lost_.begin(), lost_.end());
  EXPECT_EQ(order->missing, lost_);
  EXPECT_EQ(order->extra.size(), draws_.size());
  for (const std::uint32_t host : order->extra) EXPECT_EQ(expected_[host], host_order::none);
  std::size_t there = 0;
  for (std::uint32_t source = 0; source < 400; ++source) {
    const std::uint32_t host = order->host_of_source[source];
    if (host == host_order::none) continue;
    ++there;
    EXPECT_EQ(expected_[host], source);
  }
  EXPECT_EQ(there + lost_.size(), 400u);
}

TEST_F(kept_order, gives_the_visible_clusters_and_polygons_of_the_host) {
  const std::optional<host_order> order = order_of_host(matched(), 400, host_count_);
  ASSERT_TRUE(order);
  std::vector<std::uint32_t> cluster_of_host;  // 8 polygons of the host each
  for (std::uint32_t host = 0; host < host_count_; ++host) cluster_of_host.push_back(host / 8);
  const std::uint32_t clusters = (host_count_ + 7) / 8;
  const std::vector<std::uint32_t> table = clusters_by_source(*order, cluster_of_host);
  ASSERT_EQ(table.size(), 400u);
  sightcell_cluster_map* map = nullptr;
  ASSERT_EQ(sightcell_cluster_map_create(file_.db(), table.data(), table.size(), clusters, &map), SIGHTCELL_OK);
  const std::vector<std::uint32_t> of_stored = host_polygons_by_stored(*order, stored_);
  ASSERT_EQ(of_stored.size(), 400u);
  test_view view(file_.db());
  const sample_contents made = contents();
  std::size_t visible = 0;
  for (const auto& b : made.cells) {
    static_cast<void>(view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2));
    std::vector<std::uint32_t> expected, polygons, row((clusters + 31) / 32), expected_row(row.size(), 0);
    for (const std::uint32_t source : view.polygons()) {
      const auto found = std::find(expected_.begin(), expected_.end(), source);
      if (found == expected_.end()) continue;
      expected.push_back(static_cast<std::uint32_t>(found - expected_.begin()));
      expected_row[expected.back() / 8 / 32] |= 1u << expected.back() / 8 % 32;
    }
    for (const std::uint32_t stored : polygons_of(view.ranges(), made)) {
      if (of_stored[stored] != host_order::none) polygons.push_back(of_stored[stored]);
    }
    std::sort(expected.begin(), expected.end());
    std::sort(polygons.begin(), polygons.end());
    EXPECT_EQ(polygons, expected);
    ASSERT_EQ(sightcell_view_clusters(view.get(), map, row.data(), row.size()), SIGHTCELL_OK);
    EXPECT_EQ(row, expected_row);
    visible += expected.size();
  }
  EXPECT_GT(visible, 100u);
  sightcell_cluster_map_destroy(map);
}

TEST_F(kept_order, rejects_what_contradicts_itself) {
  const std::vector<matched_draw> good = matched();
  const auto with = [&](std::size_t draw, auto change) {
    std::vector<matched_draw> changed = good;
    change(changed[draw]);
    return order_of_host(changed, 400, host_count_).has_value();
  };
  std::size_t large = 0;  // a draw with some polygons
  while (draws_[large].polygon_count < 8) ++large;
  EXPECT_TRUE(with(large, [](matched_draw&) {}));
  EXPECT_FALSE(with(large, [](matched_draw& d) { d.triangles = nullptr; }));
  EXPECT_FALSE(with(large, [](matched_draw& d) { d.first_of_part = d.first_of_part.first(1); })) << "no second part";
  EXPECT_FALSE(with(large, [](matched_draw& d) { d.draw.first_source = 400; })) << "of another file";
  EXPECT_FALSE(with(large, [](matched_draw& d) { ++d.draw.polygon_count; })) << "of another primitive";
  EXPECT_FALSE(order_of_host(good, 400, host_count_ / 2)) << "too few polygons of the host";
  std::vector<matched_draw> twice = good;
  twice.push_back(good[large]);
  EXPECT_FALSE(order_of_host(twice, 400, host_count_)) << "a draw twice";
  const std::array<std::uint32_t, 2> same{firsts_[large][0], firsts_[large][0]};
  EXPECT_FALSE(with(large, [&](matched_draw& d) { d.first_of_part = same; })) << "two parts in one place";
  const std::optional<host_order> order = order_of_host(good, 400, host_count_);
  EXPECT_TRUE(clusters_by_source(*order, std::vector<std::uint32_t>(host_count_ - 1)).empty());
  EXPECT_TRUE(host_polygons_by_stored(*order, std::span(stored_).first(399)).empty());
}

}  // namespace
