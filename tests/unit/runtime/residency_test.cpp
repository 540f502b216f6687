// The levels of textures, compared with those that the file was made from.
#include "sightcell/residency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "loaded_file.h"
#include "sightcell/format/layout.h"
#include "unit/format/residency_samples.h"

namespace {

using namespace sightcell::test;
namespace format = sightcell::format;
using levels = std::vector<std::uint8_t>;

struct residency_release {
  void operator()(sightcell_residency* residency) const { sightcell_residency_destroy(residency); }
};
using residency_handle = std::unique_ptr<sightcell_residency, residency_release>;

residency_handle open_residency(const sightcell_db* db) {
  sightcell_residency* residency = nullptr;
  EXPECT_EQ(sightcell_residency_create(db, &residency), SIGHTCELL_OK);
  return residency_handle(residency);
}

levels levels_here(const test_view& view, const residency_handle& residency, float pixels) {
  levels out(3);
  std::size_t count = 0;
  EXPECT_EQ(sightcell_view_texture_levels(view.get(), residency.get(), pixels, out.data(), 3, &count), SIGHTCELL_OK);
  EXPECT_EQ(count, 3u);
  return out;
}

levels levels_of_cell(const residency_handle& residency, std::uint32_t cell, float pixels) {
  levels out(3);
  std::size_t count = 0;
  EXPECT_EQ(sightcell_residency_cell_levels(residency.get(), cell, pixels, out.data(), 3, &count), SIGHTCELL_OK);
  return out;
}

// By the definition in the specification, in double.
std::uint8_t expected_level(std::uint8_t number, const format::texture_record& texture, double ratio) {
  if (number == format::no_level) return SIGHTCELL_NO_LEVEL;
  if (number == format::finest_level) return 0;
  const double level = std::floor((number - 17) / 4.0 - std::log2(ratio));
  const double last = std::floor(std::log2(std::max(texture.width, texture.height)));
  return static_cast<std::uint8_t>(std::clamp(level, 0.0, last));
}

TEST(residency, levels_are_those_of_the_cell_for_any_picture) {
  const sample_contents contents = small_contents();
  const sample_residency samples(contents);
  const loaded_file file(with_residency(contents.encode(), samples));
  const residency_handle residency = open_residency(file.db());
  test_view view(file.db());
  std::array<sightcell_texture, 3> textures{};
  std::size_t count = 0;
  ASSERT_EQ(sightcell_residency_textures(residency.get(), textures.data(), 3, &count), SIGHTCELL_OK);
  EXPECT_EQ(textures[2].image, 3u);
  EXPECT_EQ(textures[2].width, 300u);
  EXPECT_EQ(textures[2].height, 700u);
  std::uint32_t compared = 0;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& box = contents.cells[cell];
    const sightcell_frame frame =
        view.move(0.5f * (box.min[0] + box.max[0]), 0.5f * (box.min[1] + box.max[1]), 0.5f * (box.min[2] + box.max[2]));
    for (const double ratio : {1.0, 0.5, 0.25, 4.0, 1.1, 0.9, 1000.0, 1e-30}) {
      levels expected;
      for (std::size_t i = 0; i < 3; ++i)
        expected.push_back(expected_level(samples.levels[cell][i], samples.textures[i], ratio));
      const auto pixels = static_cast<float>(1000.0 * ratio);
      EXPECT_EQ(levels_of_cell(residency, cell, pixels), expected) << cell << ' ' << ratio;
      if (frame.cell != cell) continue;  // in a smaller cell inside it
      EXPECT_EQ(levels_here(view, residency, pixels), expected) << cell << ' ' << ratio;
      ++compared;
    }
  }
  EXPECT_GT(compared, 100u);
}

TEST(residency, of_several_cells_is_the_finest) {
  const sample_contents contents = small_contents();
  const sample_residency samples(contents);
  const loaded_file file(with_residency(contents.encode(), samples));
  const residency_handle residency = open_residency(file.db());
  test_view view(file.db());
  const float min[3] = {3.2f, 0.2f, 0.2f}, max[3] = {4.8f, 0.8f, 0.8f};
  sightcell_frame frame{};
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  ASSERT_EQ(frame.flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
  const levels three = levels_of_cell(residency, 3, 1000.0f), four = levels_of_cell(residency, 4, 1000.0f);
  levels finest;
  for (std::size_t i = 0; i < 3; ++i) finest.push_back(std::min(three[i], four[i]));  // NO_LEVEL is the largest
  EXPECT_NE(three, four);
  EXPECT_EQ(levels_here(view, residency, 1000.0f), finest);
}

TEST(residency, needs_everything_outside_all_cells_and_where_it_is_damaged) {
  const sample_contents contents = small_contents();
  std::vector<std::byte> bytes = with_residency(contents.encode(), sample_residency(contents));
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open(bytes.data(), bytes.size(), nullptr, &db), SIGHTCELL_OK);
  {
    const residency_handle residency = open_residency(db);
    test_view view(db);
    static_cast<void>(view.move(1e6f, 0, 0));
    EXPECT_EQ(levels_here(view, residency, 1000.0f), levels(3, 0));
    const auto& box = contents.cells[40];
    static_cast<void>(view.move(box.min[0], box.min[1], box.min[2]));
    EXPECT_NE(levels_here(view, residency, 1000.0f), levels(3, 0));
    // The bytes of the file change after they were checked; chunks then end after the section.
    const std::size_t begin = section_offset(bytes, format::layout::section_residency);
    const std::size_t size = get_u64(bytes, section_place(bytes, format::layout::section_residency) + 16);
    const std::size_t head = format::layout::residency_head_size;
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin + head), size - head, std::byte{0xFF});
    EXPECT_EQ(levels_here(view, residency, 1000.0f), levels(3, 0));
  }
  sightcell_db_close(db);
}

TEST(residency, rejects_pictures_without_a_density) {
  const sample_contents contents = small_contents();
  const loaded_file file(with_residency(contents.encode(), sample_residency(contents)));
  const residency_handle residency = open_residency(file.db());
  std::size_t count = 0;
  levels out(3);
  for (const float pixels : {0.0f, -1.0f, std::nanf(""), 1048577.0f, INFINITY})
    EXPECT_EQ(sightcell_residency_cell_levels(residency.get(), 0, pixels, out.data(), 3, &count),
              SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_residency_cell_levels(residency.get(), 0, 1048576.0f, out.data(), 3, &count), SIGHTCELL_OK);
}

}  // namespace
