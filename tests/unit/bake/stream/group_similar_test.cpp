// Groups of polygons that are visible from the same cells at the same size.
#include "stream/group_similar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace sightcell::bake {
namespace {

// `items` items that one of several sets of cells sees, mixed; items of one set are in the same cells, with one class.
struct mixed_sets {
  sketch_table seen;
  std::vector<grouped_item> items;

  mixed_sets(std::uint32_t count, std::uint32_t sets) : seen(count) {
    for (std::uint32_t cell = 0; cell < 40 * sets; ++cell) {
      seen.begin_cell(cell);
      for (std::uint32_t i = cell % sets; i < count; i += sets) seen.add(i, static_cast<std::uint8_t>(3 + cell % 5));
    }
    for (std::uint32_t i = 0; i < count; ++i) items.push_back({&seen[i], glm::vec3(static_cast<float>(i)), 1, i});
  }
};

TEST(sketches, share_components_as_elements_are_shared) {
  constexpr std::uint32_t pairs = 200;
  sketch_table seen(2 * pairs);
  // Of each pair, one item is in cells 0 .. 29 of its own, the other one in 10 .. 39: half of all elements in common.
  for (std::uint32_t pair = 0; pair < pairs; ++pair)
    for (std::uint32_t cell = 0; cell < 40; ++cell) {
      seen.begin_cell(40 * pair + cell);
      if (cell < 30) seen.add(2 * std::size_t{pair}, 9);
      if (cell >= 10) seen.add(2 * std::size_t{pair} + 1, 9);
    }
  std::uint32_t shared = 0;
  for (std::uint32_t pair = 0; pair < pairs; ++pair)
    for (std::size_t i = 0; i < sketch_size; ++i) shared += seen[2 * pair][i] == seen[2 * pair + 1][i];
  EXPECT_NEAR(shared / static_cast<double>(pairs * sketch_size), 0.5, 0.03);
}

TEST(sketches, of_a_larger_class_contain_those_of_a_smaller_one) {
  sketch_table seen(3);
  seen.begin_cell(7);
  seen.add(0, 2);
  seen.add(1, 8);
  sketch both = seen[0];
  join(both, seen[1]);
  EXPECT_EQ(both, seen[0]);
  EXPECT_NE(seen[0], seen[1]);
  EXPECT_EQ(seen[2], sketch_table::nothing());
}

TEST(group_similar, separates_sets_of_cells) {
  mixed_sets mixed(4'000, 20);
  for (grouped_item& item : mixed.items) item.place = glm::vec3(1.0f);  // only sketches divide
  for (const std::span<grouped_item> group : group_similar(mixed.items, 200)) {
    std::set<std::uint32_t> sets;
    for (const grouped_item& item : group) sets.insert(item.number % 20);
    EXPECT_EQ(sets.size(), 1u);
    EXPECT_EQ(group.size(), 200u);
  }
}

TEST(group_similar, keeps_the_limit_and_every_item) {
  mixed_sets mixed(1'000, 7);
  for (grouped_item& item : mixed.items) item.size = 1 + item.number % 13;
  mixed.items[500].size = 1'000;  // alone above the limit
  std::vector<std::uint32_t> numbers;
  for (const std::span<grouped_item> group : group_similar(mixed.items, 64)) {
    std::uint64_t size = 0;
    for (const grouped_item& item : group) {
      size += item.size;
      numbers.push_back(item.number);
    }
    EXPECT_TRUE(size <= 64 || group.size() == 1);
  }
  std::sort(numbers.begin(), numbers.end());
  ASSERT_EQ(numbers.size(), 1'000u);
  for (std::uint32_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i);
}

TEST(group_similar, keeps_near_items_together_where_all_are_seen_alike) {
  mixed_sets mixed(1'024, 1);
  for (const std::span<grouped_item> group : group_similar(mixed.items, 128)) {
    const auto [low, high] = std::minmax_element(group.begin(), group.end(),
                                                 [](const auto& a, const auto& b) { return a.number < b.number; });
    EXPECT_EQ(high->number - low->number, 127u);
  }
}

TEST(group_similar, prefers_cells_to_places) {
  mixed_sets mixed(4'000, 2);
  for (const std::span<grouped_item> group : group_similar(mixed.items, 2'000))
    for (const grouped_item& item : group) EXPECT_EQ(item.number % 2, group.front().number % 2);
}

TEST(group_similar, divides_items_that_are_in_one_place) {
  mixed_sets mixed(100, 1);
  for (grouped_item& item : mixed.items) item.place = glm::vec3(1.0f);
  EXPECT_EQ(group_similar(mixed.items, 10).size(), 16u);
  EXPECT_TRUE(group_similar({}, 10).empty());
}

}  // namespace
}  // namespace sightcell::bake
