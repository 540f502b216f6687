// The lights of a view and the polygons that they reach, compared with what the file was made from.
#include "sightcell/lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "loaded_file.h"
#include "sightcell/format/layout.h"
#include "unit/format/light_samples.h"

namespace {

using namespace sightcell::test;
using numbers = std::vector<std::uint32_t>;

struct lights_release {
  void operator()(sightcell_lights* lights) const { sightcell_lights_destroy(lights); }
};
using lights_handle = std::unique_ptr<sightcell_lights, lights_release>;

lights_handle open_lights(const sightcell_db* db) {
  sightcell_lights* lights = nullptr;
  EXPECT_EQ(sightcell_lights_create(db, &lights), SIGHTCELL_OK);
  return lights_handle(lights);
}

numbers lights_here(const test_view& view, const lights_handle& lights) {
  numbers out(10);
  std::size_t count = 0;
  EXPECT_EQ(sightcell_view_lights(view.get(), lights.get(), out.data(), out.size(), &count), SIGHTCELL_OK);
  out.resize(count);
  return out;
}

std::vector<sightcell_range> lit_ranges(const test_view& view, const lights_handle& lights, std::uint32_t light) {
  std::size_t count = 0;
  static_cast<void>(sightcell_view_light_ranges(view.get(), lights.get(), light, nullptr, 0, &count));
  std::vector<sightcell_range> ranges(count);
  EXPECT_EQ(sightcell_view_light_ranges(view.get(), lights.get(), light, ranges.data(), count, &count), SIGHTCELL_OK);
  return ranges;
}

// Source ids, by the index list, whose numbers are those of stored polygons here.
numbers lit_polygons(const sightcell_db* db, const test_view& view, const lights_handle& lights, std::uint32_t light) {
  const std::uint32_t polygons = sightcell_db_polygon_count(db);
  numbers indices(3 * std::size_t{polygons}), drawn(indices.size()), order(polygons), sources;
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i / 3);
  std::size_t count = 0, ordered = 0;
  EXPECT_EQ(
      sightcell_view_light_indices(view.get(), lights.get(), light, indices.data(), drawn.data(), drawn.size(), &count),
      SIGHTCELL_OK);
  EXPECT_EQ(sightcell_db_order(db, order.data(), order.size(), &ordered), SIGHTCELL_OK);
  for (std::size_t i = 0; i < count; i += 3) sources.push_back(order[drawn[i]]);
  std::sort(sources.begin(), sources.end());
  return sources;
}

TEST(lights, reach_what_the_file_states_and_touch_the_cells_that_see_it) {
  const sample_contents contents = small_contents();
  const sample_lights samples(contents);
  const loaded_file file(with_lights(contents.encode(), samples));
  const lights_handle lights = open_lights(file.db());
  test_view view(file.db());
  EXPECT_EQ(lights_here(view, lights).size(), 10u) << "before the first move";
  std::uint32_t compared = 0, dark = 0;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& box = contents.cells[cell];
    const sightcell_frame frame =
        view.move(0.5f * (box.min[0] + box.max[0]), 0.5f * (box.min[1] + box.max[1]), 0.5f * (box.min[2] + box.max[2]));
    if (frame.cell != cell) continue;  // in a smaller cell inside it
    numbers expected;
    for (std::uint32_t light = 0; light < 10; ++light)
      if (samples.touching[cell][light]) expected.push_back(light);
    EXPECT_EQ(lights_here(view, lights), expected) << cell;
    dark += static_cast<std::uint32_t>(10 - expected.size());
    ++compared;
  }
  EXPECT_GT(compared, 10u);
  EXPECT_GT(dark, compared) << "light 4 reaches nothing";
  for (std::uint32_t light = 0; light < 10; ++light) {
    EXPECT_EQ(lit_polygons(file.db(), view, lights, light), samples.sets[light]) << light;
    std::size_t sum = 0;
    for (const sightcell_range& r : lit_ranges(view, lights, light)) sum += r.count;
    EXPECT_EQ(sum, samples.sets[light].size()) << light;
  }
}

TEST(lights, of_several_cells_are_those_of_each) {
  const sample_contents contents = small_contents();
  sample_lights samples(contents);
  samples.touching[3].assign(10, false);
  samples.touching[4].assign(10, false);
  samples.touching[3][1] = samples.touching[4][2] = samples.touching[3][9] = samples.touching[4][9] = true;
  const loaded_file file(with_lights(contents.encode(), samples));
  const lights_handle lights = open_lights(file.db());
  test_view view(file.db());
  const float min[3] = {3.2f, 0.2f, 0.2f}, max[3] = {4.8f, 0.8f, 0.8f};
  sightcell_frame frame{};
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(lights_here(view, lights), (numbers{1, 2, 9}));
}

TEST(lights, are_all_outside_all_cells_and_reach_everything_where_they_are_damaged) {
  const sample_contents contents = small_contents();
  std::vector<std::byte> bytes = with_lights(contents.encode(), sample_lights(contents));
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open(bytes.data(), bytes.size(), nullptr, &db), SIGHTCELL_OK);
  {
    const lights_handle lights = open_lights(db);
    test_view view(db);
    static_cast<void>(view.move(1e6f, 0, 0));
    EXPECT_EQ(lights_here(view, lights).size(), 10u);
    EXPECT_LT(lit_polygons(db, view, lights, 0).size(), sightcell_db_polygon_count(db));
    // The bytes of the file change after they were checked.
    const std::size_t begin = section_offset(bytes, sightcell::format::layout::section_lights);
    const std::size_t size = get_u64(bytes, section_place(bytes, sightcell::format::layout::section_lights) + 16);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin + size / 2), size - size / 2, std::byte{0xFF});
    EXPECT_EQ(lit_polygons(db, view, lights, 0).size(), sightcell_db_polygon_count(db));
  }
  sightcell_db_close(db);
}

TEST(lights, do_not_reach_hidden_groups) {
  sample_contents contents = small_contents();
  contents.named_groups = {"gate"};
  const auto gate =
      std::find_if(contents.draws.begin(), contents.draws.end(), [](const auto& d) { return d.polygon_count > 0; });
  gate->named_group = 0;
  const loaded_file file(with_lights(contents.encode(), sample_lights(contents)));
  const lights_handle lights = open_lights(file.db());
  test_view view(file.db());
  const auto number = static_cast<std::uint32_t>(gate - contents.draws.begin());
  const auto drawn = [&] {
    const auto ranges = lit_ranges(view, lights, 9);
    return std::count_if(ranges.begin(), ranges.end(), [&](const auto& r) { return r.draw == number; });
  };
  EXPECT_EQ(drawn(), 1);
  EXPECT_EQ(sightcell_view_show_named_group(view.get(), 0, 0), SIGHTCELL_OK);
  static_cast<void>(view.move(0, 0, 0));
  EXPECT_EQ(drawn(), 0);
  EXPECT_FALSE(lit_ranges(view, lights, 9).empty());
}

TEST(lights, have_what_the_file_states) {
  const sample_contents contents = small_contents();
  const loaded_file file(with_lights(contents.encode(), sample_lights(contents)));
  const lights_handle lights = open_lights(file.db());
  sightcell_light list[10];
  std::size_t count = 0;
  ASSERT_EQ(sightcell_lights_list(lights.get(), list, 10, &count), SIGHTCELL_OK);
  EXPECT_EQ(count, 10u);
  EXPECT_EQ(list[5].node, 16u);
  EXPECT_EQ(list[5].position[0], 5.0f);
  EXPECT_EQ(list[5].direction[2], 0.8f);
  EXPECT_EQ(list[5].range, 6.0f);
  EXPECT_EQ(list[5].cone, 0.625f);
  EXPECT_EQ(list[5].error_bound, 0.125f);
  EXPECT_TRUE(std::isinf(list[6].range));
  EXPECT_EQ(list[6].cone, 0.0f);
  sightcell_lights* none = nullptr;
  const loaded_file without(contents);
  EXPECT_EQ(sightcell_lights_create(without.db(), &none), SIGHTCELL_ERR_ABSENT);
  EXPECT_EQ(none, nullptr);
}

}  // namespace
