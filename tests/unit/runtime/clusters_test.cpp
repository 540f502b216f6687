// Bits of the host's clusters, compared with the polygons of the view one by one.
#include "sightcell/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "held_memory.h"
#include "loaded_file.h"
#include "unit/format/cluster_samples.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;
using words = std::vector<std::uint32_t>;

struct map_release {
  void operator()(sightcell_cluster_map* map) const { sightcell_cluster_map_destroy(map); }
};
using map_handle = std::unique_ptr<sightcell_cluster_map, map_release>;

map_handle make_map(const sightcell_db* db, const words& table, std::uint32_t clusters,
                    sightcell_status expected = SIGHTCELL_OK) {
  sightcell_cluster_map* map = nullptr;
  EXPECT_EQ(sightcell_cluster_map_create(db, table.data(), table.size(), clusters, &map), expected);
  return map_handle(map);
}

words row_of(const test_view& view, const map_handle& map, std::size_t size) {
  words row(size, 0xFFFFFFFFu);
  EXPECT_EQ(sightcell_view_clusters(view.get(), map.get(), row.data(), row.size()), SIGHTCELL_OK);
  return row;
}

// The row by its definition.
words expected_row(const words& polygons, const words& table, std::size_t size) {
  words row(size, 0);
  for (const std::uint32_t polygon : polygons) {
    if (table[polygon] != SIGHTCELL_NO_CLUSTER) row[table[polygon] / 32] |= 1u << table[polygon] % 32;
  }
  return row;
}

// Clusters of neighboring polygons, of polygons from anywhere, and of none.
std::vector<words> tables_of(std::uint32_t polygons, std::uint32_t clusters, std::uint32_t seed) {
  random_source random(seed);
  std::vector<words> tables(3, words(polygons));
  for (std::uint32_t i = 0; i < polygons; ++i) {
    tables[0][i] = i * clusters / polygons;
    tables[1][i] = random() % clusters;
    tables[2][i] = random() % 3 == 0 ? SIGHTCELL_NO_CLUSTER : i * clusters / polygons;
  }
  return tables;
}

void expect_clusters(const sample_contents& contents, std::uint32_t clusters, const std::vector<words>& tables) {
  const loaded_file file(contents);
  test_view view(file.db());
  const std::size_t size = (clusters + 31) / 32 + 1;  // one word more than needed
  for (const words& table : tables) {
    const map_handle map = make_map(file.db(), table, clusters);
    ASSERT_NE(map, nullptr);
    std::size_t bits = 0;
    words before(size, 0);
    static_cast<void>(view.move(-1e6f, 0, 0));
    EXPECT_EQ(row_of(view, map, size), expected_row(all_polygons(contents.facts.polygon_count), table, size))
        << "under DRAW_ALL";
    for (const auto& b : contents.cells) {
      static_cast<void>(view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2));
      const words row = row_of(view, map, size);
      ASSERT_EQ(row, expected_row(view.polygons(), table, size));

      words list(clusters);
      std::size_t count = 0;
      ASSERT_EQ(sightcell_cluster_list(row.data(), size, list.data(), list.size(), &count), SIGHTCELL_OK);
      list.resize(count);
      EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
      words again(size, 0);
      for (const std::uint32_t cluster : list) again[cluster / 32] |= 1u << cluster % 32;
      ASSERT_EQ(again, row);
      bits += count;

      std::vector<sightcell_cluster_word> changed(size);
      ASSERT_EQ(sightcell_cluster_changes(before.data(), row.data(), size, changed.data(), size, &count), SIGHTCELL_OK);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_NE(before[changed[i].index], changed[i].bits) << "not a change";
        before[changed[i].index] = changed[i].bits;
      }
      ASSERT_EQ(before, row);
    }
    EXPECT_GT(bits, contents.cells.size());
  }
}

void expect_clusters(const sample_contents& contents, std::uint32_t clusters, std::uint32_t seed) {
  expect_clusters(contents, clusters, tables_of(contents.facts.polygon_count, clusters, seed));
}

TEST(clusters, instanced) {
  expect_clusters(random_contents(41, {.polygons = 800, .draws = 20, .cells = 40}), 100, 1);
  sample_contents shared = random_contents(42, {.polygons = 800, .draws = 63, .cells = 40});
  put_in_order(shared, 5);
  expect_clusters(shared, 64, 2);
}

TEST(clusters, merged) {
  sample_contents contents = random_contents(43, {.polygons = 800, .draws = 90, .cells = 40});
  put_in_groups(contents, 43);
  expect_clusters(contents, 33, 3);
}

// A map keeps the clusters of polygons in windows of 16,384.
TEST(clusters, far_from_each_other) {
  const sample_contents contents = random_contents(46, {.polygons = 3000, .draws = 10, .cells = 20});
  std::vector<words> tables(5, words(3000));
  random_source random(47);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    tables[0][i] = (i < 1500 ? 16'000 : 70'000) + i % 80;         // two windows
    tables[1][i] = i / 100 % 2 * 65'536 + i % 32;                 // many
    tables[2][i] = random() % 100'000;                            // each polygon far from the next
    tables[3][i] = i < 1500 ? SIGHTCELL_NO_CLUSTER : i * 33 - 1;  // the last cluster is 98,966
    tables[4][i] = 99'998 + i % 2;
  }
  expect_clusters(contents, 100'000, tables);
}

// Runs that begin and end anywhere in blocks of 16 and 128 polygons.
TEST(clusters, every_begin_and_end_of_a_run) {
  sample_contents contents = random_contents(44, {.polygons = 300, .draws = 1, .cells = 40});
  random_source random(45);
  for (words& set : contents.sets) {
    const std::uint32_t first = random() % 300;
    const std::uint32_t count = 1 + random() % (300 - first);
    set.clear();
    for (std::uint32_t i = 0; i < count; ++i) set.push_back(first + i);
  }
  expect_clusters(contents, 300, 4);
}

// In a file of clusters: its own clusters, tables of the host that unite or divide them.
void expect_file_clusters(const sample_contents& contents) {
  const loaded_file file(contents);
  const words own = cluster_of_source(contents);
  const std::uint32_t clusters = 1 + *std::max_element(own.begin(), own.end());
  ASSERT_EQ(sightcell_db_cluster_count(file.db()), clusters);
  std::vector<sightcell_range> ranges(clusters);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_clusters(file.db(), ranges.data(), clusters, &count), SIGHTCELL_OK);
  std::uint32_t stored = 0;
  for (const sightcell_range& r : ranges) stored += r.count;
  EXPECT_EQ(stored, contents.facts.polygon_count);
  words united = own, divided = own;
  for (std::uint32_t& cluster : united) cluster = cluster % 7 == 3 ? SIGHTCELL_NO_CLUSTER : (clusters - cluster) / 3;
  for (std::uint32_t i = 0; i < divided.size(); ++i) divided[i] = 2 * divided[i] + i % 2;
  sightcell_cluster_map* of_file = nullptr;
  ASSERT_EQ(sightcell_cluster_map_of_file(file.db(), &of_file), SIGHTCELL_OK);
  std::vector<std::pair<map_handle, words>> maps;
  maps.emplace_back(of_file, own);
  for (const words& table : {united, divided}) maps.emplace_back(make_map(file.db(), table, 2 * clusters), table);
  const std::size_t size = (2 * clusters + 31) / 32;
  test_view view(file.db());
  static_cast<void>(view.move(-1e6f, 0, 0));
  for (std::size_t cell = 0; cell <= contents.cells.size(); ++cell) {
    for (const auto& [map, table] : maps)
      ASSERT_EQ(row_of(view, map, size), expected_row(view.polygons(), table, size)) << cell;
    if (cell == contents.cells.size()) break;
    const auto& b = contents.cells[cell];
    static_cast<void>(view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2));
  }
}

TEST(clusters, of_the_file) {
  sample_contents contents = random_contents(46, {.polygons = 1500, .draws = 20, .cells = 40});
  put_in_order(contents, 7);
  put_in_clusters(contents, 47, 90);
  expect_file_clusters(contents);
  sample_contents merged = random_contents(48, {.polygons = 1500, .draws = 40, .cells = 40});
  put_in_groups(merged, 8);
  put_in_clusters(merged, 49, 4);
  expect_file_clusters(merged);
}

TEST(clusters, hidden_groups_have_no_bits_under_draw_all) {
  sample_contents contents = small_contents();
  contents.named_groups = {"door"};
  contents.draws[2].named_group = 0;
  const loaded_file file(contents);
  test_view view(file.db());
  words table(300, 0);
  for (std::uint32_t i = 0; i < contents.draws[2].polygon_count; ++i) table[contents.draws[2].first_source + i] = 1;
  const map_handle map = make_map(file.db(), table, 2);
  static_cast<void>(view.move(-1e6f, 0, 0));
  EXPECT_EQ(row_of(view, map, 1), words{3});
  ASSERT_EQ(sightcell_view_show_named_group(view.get(), 0, 0), SIGHTCELL_OK);
  static_cast<void>(view.move(-1e6f, 0, 0));
  EXPECT_EQ(row_of(view, map, 1), words{1});
}

TEST(clusters, wrong_tables_and_rows) {
  held_memory memory;
  const loaded_file file(tiny_contents().encode(), &memory.interface);
  const loaded_file other(tiny_contents());
  const test_view view(file.db());
  const words table{0, 1, 2, 3, SIGHTCELL_NO_CLUSTER, 31};
  const std::size_t held = memory.bytes;
  EXPECT_EQ(make_map(file.db(), {0, 1, 2, 3, 4}, 32, SIGHTCELL_ERR_ARGUMENT), nullptr) << "too few polygons";
  EXPECT_EQ(make_map(file.db(), {0, 1, 2, 3, 4, 5, 6}, 32, SIGHTCELL_ERR_ARGUMENT), nullptr) << "too many";
  EXPECT_EQ(make_map(file.db(), table, 31, SIGHTCELL_ERR_ARGUMENT), nullptr) << "no such cluster";
  EXPECT_EQ(sightcell_cluster_map_create(file.db(), table.data(), 6, 32, nullptr), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(make_map(nullptr, table, 32, SIGHTCELL_ERR_ARGUMENT), nullptr);
  EXPECT_EQ(memory.bytes, held);
  {
    const map_handle map = make_map(file.db(), table, 32);
    EXPECT_GT(memory.bytes, held);
    EXPECT_EQ(row_of(view, map, 1), words{0}) << "before the first move";
    const map_handle of_other = make_map(other.db(), table, 32);
    words row(1, 7);
    EXPECT_EQ(sightcell_view_clusters(view.get(), of_other.get(), row.data(), 1), SIGHTCELL_ERR_ARGUMENT);
    EXPECT_EQ(sightcell_view_clusters(view.get(), nullptr, row.data(), 1), SIGHTCELL_ERR_ARGUMENT);
    EXPECT_EQ(sightcell_view_clusters(nullptr, map.get(), row.data(), 1), SIGHTCELL_ERR_ARGUMENT);
    EXPECT_EQ(sightcell_view_clusters(view.get(), map.get(), row.data(), 0), SIGHTCELL_ERR_CAPACITY);
    EXPECT_EQ(row[0], 7u) << "nothing is written";
  }
  EXPECT_EQ(memory.bytes, held) << "the map is released with its size";
  const map_handle none = make_map(file.db(), words(6, SIGHTCELL_NO_CLUSTER), 0);
  EXPECT_EQ(sightcell_view_clusters(view.get(), none.get(), nullptr, 0), SIGHTCELL_OK) << "a host without clusters";
  sightcell_cluster_map_destroy(nullptr);
}

TEST(clusters, a_list_that_does_not_fit_is_not_written) {
  const words before{0, 5, 0}, row{6, 5, 1};
  words list(2, 9);
  std::vector<sightcell_cluster_word> changed(1, {9, 9});
  std::size_t count = 0;
  EXPECT_EQ(sightcell_cluster_list(row.data(), 3, list.data(), 2, &count), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(count, 5u);
  EXPECT_EQ(list, (words{9, 9}));
  EXPECT_EQ(sightcell_cluster_changes(before.data(), row.data(), 3, changed.data(), 1, &count), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(count, 2u);
  EXPECT_EQ(changed[0].index, 9u);
  EXPECT_EQ(sightcell_cluster_list(nullptr, 0, nullptr, 0, &count), SIGHTCELL_OK);
  EXPECT_EQ(count, 0u);
  EXPECT_EQ(sightcell_cluster_list(row.data(), 3, list.data(), 2, nullptr), SIGHTCELL_ERR_ARGUMENT);
}

}  // namespace
