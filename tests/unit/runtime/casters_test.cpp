// The polygons for shadow maps, compared with the sets and casters that the file was made from.
#include "sightcell/casters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "loaded_file.h"
#include "sightcell/format/layout.h"
#include "unit/format/caster_samples.h"

namespace {

using namespace sightcell::test;
using ids = std::vector<std::uint32_t>;

struct casters_release {
  void operator()(sightcell_casters* casters) const { sightcell_casters_destroy(casters); }
};
using casters_handle = std::unique_ptr<sightcell_casters, casters_release>;

casters_handle open_casters(const sightcell_db* db) {
  sightcell_casters* casters = nullptr;
  EXPECT_EQ(sightcell_casters_create(db, &casters), SIGHTCELL_OK);
  return casters_handle(casters);
}

std::vector<sightcell_range> ranges_of(const test_view& view, const casters_handle& casters, std::uint32_t sun) {
  std::size_t count = 0;
  static_cast<void>(sightcell_view_casters(view.get(), casters.get(), sun, nullptr, 0, &count));
  std::vector<sightcell_range> ranges(count);
  EXPECT_EQ(sightcell_view_casters(view.get(), casters.get(), sun, ranges.data(), count, &count), SIGHTCELL_OK);
  return ranges;
}

// By the index list, whose numbers are those of stored polygons here.
ids stored_of(const test_view& view, const casters_handle& casters, std::uint32_t sun, std::uint32_t polygons) {
  ids indices(3 * std::size_t{polygons});
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i / 3);
  ids drawn(indices.size());
  std::size_t count = 0;
  EXPECT_EQ(
      sightcell_view_caster_indices(view.get(), casters.get(), sun, indices.data(), drawn.data(), drawn.size(), &count),
      SIGHTCELL_OK);
  ids stored;
  for (std::size_t i = 0; i < count; i += 3) stored.push_back(drawn[i]);
  return stored;
}

ids sources_of(const sightcell_db* db, const ids& stored) {
  ids order(sightcell_db_polygon_count(db)), sources;
  std::size_t count = 0;
  EXPECT_EQ(sightcell_db_order(db, order.data(), order.size(), &count), SIGHTCELL_OK);
  for (const std::uint32_t polygon : stored) sources.push_back(order[polygon]);
  std::sort(sources.begin(), sources.end());
  return sources;
}

TEST(casters, are_drawn_with_the_set_of_the_cell) {
  const sample_contents contents = small_contents();
  const sample_casters samples(contents);
  const loaded_file file(with_casters(contents.encode(), samples));
  const casters_handle casters = open_casters(file.db());
  test_view view(file.db());
  const std::uint32_t polygons = sightcell_db_polygon_count(file.db());
  std::uint32_t compared = 0;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& box = contents.cells[cell];
    const sightcell_frame frame =
        view.move(0.5f * (box.min[0] + box.max[0]), 0.5f * (box.min[1] + box.max[1]), 0.5f * (box.min[2] + box.max[2]));
    if (frame.cell != cell) continue;  // in a smaller cell inside it
    for (std::uint32_t sun = 0; sun < 2; ++sun) {
      ids expected;
      const auto& extra = samples.sets[2 * cell + sun];
      std::set_union(contents.sets[cell].begin(), contents.sets[cell].end(), extra.begin(), extra.end(),
                     std::back_inserter(expected));
      EXPECT_EQ(sources_of(file.db(), stored_of(view, casters, sun, polygons)), expected) << cell << ' ' << sun;
      std::uint64_t sum = 0;
      std::uint32_t draw = 0;
      for (const sightcell_range& r : ranges_of(view, casters, sun)) {
        EXPECT_GE(r.draw, draw);
        draw = r.draw;
        sum += r.count;
      }
      EXPECT_EQ(sum, expected.size());
      ++compared;
    }
  }
  EXPECT_GT(compared, 10u);
}

TEST(casters, are_everything_outside_all_cells_and_where_they_are_damaged) {
  const sample_contents contents = small_contents();
  std::vector<std::byte> bytes = with_casters(contents.encode(), sample_casters(contents));
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open(bytes.data(), bytes.size(), nullptr, &db), SIGHTCELL_OK);
  {
    const casters_handle casters = open_casters(db);
    test_view view(db);
    const std::uint32_t polygons = sightcell_db_polygon_count(db);
    static_cast<void>(view.move(1e6f, 0, 0));
    EXPECT_EQ(stored_of(view, casters, 0, polygons).size(), polygons);
    const auto& box = contents.cells[0];
    static_cast<void>(view.move(box.min[0], box.min[1], box.min[2]));
    EXPECT_LT(stored_of(view, casters, 0, polygons).size(), polygons);
    // The bytes of the file change after they were checked.
    const std::size_t begin = section_offset(bytes, sightcell::format::layout::section_casters);
    const std::size_t size = get_u64(bytes, section_place(bytes, sightcell::format::layout::section_casters) + 16);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin + size / 4), size - size / 4, std::byte{0xFF});
    EXPECT_EQ(stored_of(view, casters, 0, polygons).size(), polygons);
  }
  sightcell_db_close(db);
}

TEST(casters, of_hidden_groups_are_left_out) {
  sample_contents contents = small_contents();
  contents.named_groups = {"gate"};
  const auto with_polygons =
      std::find_if(contents.draws.begin(), contents.draws.end(), [](const auto& d) { return d.polygon_count > 0; });
  with_polygons->named_group = 0;
  const loaded_file file(with_casters(contents.encode(), sample_casters(contents)));
  const casters_handle casters = open_casters(file.db());
  test_view view(file.db());
  EXPECT_EQ(sightcell_view_show_named_group(view.get(), 0, 0), SIGHTCELL_OK);
  const auto& box = contents.cells[0];
  static_cast<void>(view.move(box.min[0], box.min[1], box.min[2]));
  const auto gate = static_cast<std::uint32_t>(with_polygons - contents.draws.begin());
  const auto ranges = ranges_of(view, casters, 0);
  EXPECT_FALSE(ranges.empty());
  EXPECT_TRUE(std::none_of(ranges.begin(), ranges.end(), [&](const auto& r) { return r.draw == gate; }));
}

TEST(casters, have_the_suns_of_the_file) {
  const sample_contents contents = small_contents();
  const loaded_file file(with_casters(contents.encode(), sample_casters(contents)));
  const casters_handle casters = open_casters(file.db());
  sightcell_sun suns[2];
  std::size_t count = 0;
  ASSERT_EQ(sightcell_casters_suns(casters.get(), suns, 2, &count), SIGHTCELL_OK);
  EXPECT_EQ(count, 2u);
  EXPECT_EQ(suns[0].from[1], 1.0f);
  EXPECT_EQ(suns[1].from[0], 0.6f);
  EXPECT_EQ(suns[1].to[2], -0.6f);
  sightcell_casters* none = nullptr;
  const loaded_file without(contents);
  EXPECT_EQ(sightcell_casters_create(without.db(), &none), SIGHTCELL_ERR_ABSENT);
  EXPECT_EQ(none, nullptr);
}

}  // namespace
