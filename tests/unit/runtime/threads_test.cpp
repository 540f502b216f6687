// One db, eight views on eight threads; meant for the thread sanitizer. All threads meet untouched chunks at once.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "loaded_file.h"
#include "sightcell/format/layout.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;

TEST(threads, eight_views_of_one_db) {
  const sample_contents contents = random_contents(61, {.polygons = 500, .draws = 20, .cells = 512});
  auto bytes = contents.encode();
  const std::size_t rows = section_offset(bytes, sightcell::format::layout::section_rows);
  const std::size_t directory = section_offset(bytes, sightcell::format::layout::section_row_directory);
  bytes[rows + get_u64(bytes, directory + 16 * 3)] ^= std::byte{1};  // chunk 3 is damaged
  const loaded_file file(std::move(bytes));
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (std::uint32_t number = 0; number < 8; ++number) {
    threads.emplace_back([&, number] {
      random_source random(number);
      sightcell_view* view = nullptr;
      if (sightcell_view_create(file.db(), &view) != SIGHTCELL_OK) ++wrong;
      std::vector<std::uint32_t> ids(500);
      for (int i = 0; i < 2000; ++i) {
        const std::uint32_t cell = random() % 512;
        const auto& b = contents.cells[cell];
        const float eye[3] = {b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f};
        sightcell_frame frame;
        std::size_t count = 0;
        if (sightcell_view_move(view, eye, &frame) != SIGHTCELL_OK || frame.cell != cell) ++wrong;
        if (sightcell_view_polygons(view, ids.data(), ids.size(), &count) != SIGHTCELL_OK) ++wrong;
        const std::size_t expected = cell / 64 == 3 ? 500 : contents.sets[cell].size();
        if (count != expected) ++wrong;
        if (cell / 64 != 3 && !std::equal(contents.sets[cell].begin(), contents.sets[cell].end(), ids.begin())) ++wrong;
      }
      sightcell_view_destroy(view);
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong.load(), 0);
}

}  // namespace
