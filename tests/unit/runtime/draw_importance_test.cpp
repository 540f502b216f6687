// The importance of draws, compared with the sum of the classes of their polygons.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "loaded_file.h"
#include "sightcell/format/importance_classes.h"
#include "unit/format/importance_samples.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;
namespace format = sightcell::format;

std::vector<std::byte> measured(const sample_contents& contents) {
  return with_importance(contents.encode(), sample_class);
}

std::vector<float> importance_in(const test_view& view, std::size_t elements, sightcell_status expected) {
  std::vector<float> out(elements, 7.0f);
  std::size_t count = 0;
  EXPECT_EQ(sightcell_view_importance(view.get(), out.data(), out.size(), &count), expected);
  EXPECT_EQ(count, elements);
  return out;
}

// By draw, or by draw group.
std::vector<double> sums_of(const sample_contents& contents, std::uint32_t cell, bool by_group) {
  std::vector<double> sums(contents.draws.size(), 0.0);
  for (const std::uint32_t polygon : contents.sets[cell])
    for (std::size_t d = 0; d < contents.draws.size(); ++d) {
      const auto& draw = contents.draws[d];
      if (polygon < draw.first_source || polygon - draw.first_source >= draw.polygon_count) continue;
      sums[by_group ? draw.group : d] +=
          std::numbers::pi / std::pow(4.0, std::min<int>(sample_class(cell, polygon), 11));
    }
  return sums;
}

void expect_sums(const std::vector<float>& found, const std::vector<double>& expected) {
  for (std::size_t d = 0; d < found.size(); ++d)
    EXPECT_NEAR(static_cast<double>(found[d]), expected[d], 1e-5 * expected[d]) << "draw " << d;
}

void enter_cell(test_view& view, const sample_contents& contents, std::uint32_t cell) {
  const auto& b = contents.cells[cell];
  static_cast<void>(view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2));
}

TEST(draw_importance, is_the_sum_of_the_classes) {
  const sample_contents contents = random_contents(41, {.polygons = 800, .draws = 100, .cells = 150});
  const loaded_file file(measured(contents));
  test_view view(file.db());
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    enter_cell(view, contents, cell);
    expect_sums(importance_in(view, contents.draws.size(), SIGHTCELL_OK), sums_of(contents, cell, false));
  }
}

TEST(draw_importance, is_of_draw_groups_in_a_merged_file) {
  sample_contents contents = random_contents(42, {.polygons = 800, .draws = 90, .cells = 50, .visible = 0.05});
  put_in_groups(contents, 42);
  const loaded_file file(measured(contents));
  std::uint32_t groups = 0;
  for (const auto& draw : contents.draws) groups = std::max(groups, draw.group + 1);
  test_view view(file.db());
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    enter_cell(view, contents, cell);
    expect_sums(importance_in(view, groups, SIGHTCELL_OK), sums_of(contents, cell, true));
  }
}

TEST(draw_importance, is_the_largest_of_the_cells_of_a_box) {
  sample_contents contents = tiny_contents();  // cells side by side along x
  contents.draws = {{.polygon_count = 3}, {.first_source = 3, .polygon_count = 3, .first_stored = 3}};
  contents.sets = {{0, 1, 2, 4}, {2, 5}};
  const loaded_file file(with_importance(contents.encode(), [](std::uint32_t cell, std::uint32_t polygon) {
    return static_cast<std::uint8_t>(cell == 0 ? polygon : polygon - 2);  // 0, 1, 2, 4 and 0, 3
  }));
  test_view view(file.db());
  sightcell_frame frame;
  const float min[3] = {1, 1, 1}, max[3] = {7, 1, 1};
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  ASSERT_EQ(frame.polygon_count, 5u);
  const float pi = std::numbers::pi_v<float>;
  const auto both = importance_in(view, 2, SIGHTCELL_OK);
  EXPECT_FLOAT_EQ(both[0], pi + pi / 4 + pi / 16);
  EXPECT_FLOAT_EQ(both[1], pi / 64);
}

TEST(draw_importance, is_zero_for_hidden_named_groups) {
  sample_contents contents = tiny_contents();
  contents.draws = {{.polygon_count = 2}, {.first_source = 2, .polygon_count = 4, .first_stored = 2}};
  contents.named_groups = {"door"};
  contents.draws[0].named_group = 0;
  const loaded_file file(measured(contents));
  test_view view(file.db());
  enter_cell(view, contents, 0);
  const auto shown = importance_in(view, 2, SIGHTCELL_OK);
  EXPECT_GT(shown[0], 0.0f);
  ASSERT_EQ(sightcell_view_show_named_group(view.get(), 0, 0), SIGHTCELL_OK);
  enter_cell(view, contents, 0);
  const auto hidden = importance_in(view, 2, SIGHTCELL_OK);
  EXPECT_EQ(hidden[0], 0.0f);
  EXPECT_EQ(hidden[1], shown[1]);
}

TEST(draw_importance, is_not_known_everywhere) {
  const sample_contents contents = tiny_contents();
  const auto none = [](const std::vector<float>& values) { return values == std::vector<float>{0.0f}; };
  {
    const loaded_file file(contents);
    test_view view(file.db());
    enter_cell(view, contents, 0);
    EXPECT_TRUE(none(importance_in(view, 1, SIGHTCELL_ERR_ABSENT)));
  }
  const loaded_file file(measured(contents));
  test_view view(file.db());
  EXPECT_TRUE(none(importance_in(view, 1, SIGHTCELL_OK))) << "before the first move";
  static_cast<void>(view.move(-1e6f, 0, 0));
  EXPECT_TRUE(none(importance_in(view, 1, SIGHTCELL_ERR_STALE)));
  std::size_t count = 0;
  EXPECT_EQ(sightcell_view_importance(view.get(), nullptr, 0, &count), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(count, 1u);
  float value = 7.0f;
  EXPECT_EQ(sightcell_view_importance(view.get(), nullptr, 1, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_importance(view.get(), &value, 1, nullptr), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_importance(nullptr, &value, 1, &count), SIGHTCELL_ERR_ARGUMENT);
}

// Damage of this section changes nothing else.
TEST(draw_importance, damaged_bytes_are_an_error_and_the_sets_stay) {
  const sample_contents contents = random_contents(43, {.polygons = 300, .draws = 5, .cells = 3});
  const std::vector<std::byte> good = measured(contents);
  const std::size_t begin = section_offset(good, format::layout::section_importance);
  std::size_t damaged = 0;
  for (std::size_t at = begin; at < good.size(); ++at) {
    std::vector<std::byte> bytes = good;
    bytes[at] ^= std::byte{0x10};
    const loaded_file file(std::move(bytes));
    test_view view(file.db());
    enter_cell(view, contents, 1);
    std::vector<float> out(5, 7.0f);
    std::size_t count = 0;
    const sightcell_status s = sightcell_view_importance(view.get(), out.data(), out.size(), &count);
    EXPECT_TRUE(s == SIGHTCELL_ERR_CHECKSUM || s == SIGHTCELL_ERR_CORRUPT) << at << " " << s;
    EXPECT_EQ(*std::max_element(out.begin(), out.end()), 0.0f);
    EXPECT_EQ(view.polygons().size(), contents.sets[1].size());
    ++damaged;
  }
  EXPECT_GT(damaged, 100u);
}

}  // namespace
