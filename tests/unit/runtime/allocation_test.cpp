// Per-frame calls allocate nothing: counted over 10,000 moves (in a complete run) in the given allocator, in operator
// new and, where the C library allows it, in malloc itself.
#include <gtest/gtest.h>

#include <cstdlib>

#include "allocation_counter.h"
#include "loaded_file.h"
#include "sightcell/clusters.h"
#include "unit/case_step.h"
#include "unit/format/importance_samples.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;

struct counting_allocator {
  std::size_t given = 0;
  std::size_t bytes = 0;
  sightcell_allocator interface {
    [](void* user, std::size_t size, std::size_t align) -> void* {
      auto* self = static_cast<counting_allocator*>(user);
      EXPECT_TRUE(align <= 16 && (align & (align - 1)) == 0);
      ++self->given;
      self->bytes += size;
      return std::malloc(size);
    },
        [](void* user, void* block, std::size_t size) {
          static_cast<counting_allocator*>(user)->bytes -= size;
          std::free(block);
        },
        this
  };
};

TEST(allocation, none_over_10000_moves) {
  const sample_contents contents = random_contents(51, {.polygons = 3000, .draws = 40, .cells = 512});
  counting_allocator memory;
  {
    const loaded_file file(contents.encode(), &memory.interface);
    EXPECT_EQ(memory.given, 1u);
    const test_view view(file.db());
    EXPECT_EQ(memory.given, 2u);
    std::vector<std::uint32_t> ids(3000);
    for (std::uint32_t i = 0; i < 3000; ++i) ids[i] = i / 7;
    sightcell_cluster_map* map = nullptr;
    ASSERT_EQ(sightcell_cluster_map_create(file.db(), ids.data(), ids.size(), 429, &map), SIGHTCELL_OK);
    EXPECT_EQ(memory.given, 3u);
    std::vector<std::uint32_t> row(14), last_row(14);
    std::vector<sightcell_cluster_word> words(14);
    std::vector<std::uint32_t> stored(9000);
    std::vector<std::uint32_t> indices(9000);
    std::vector<sightcell_range> ranges(6000);
    std::vector<sightcell_range> more(6000);
    std::vector<sightcell_command> commands(6000);
    random_source random(52);
    std::size_t count = 0;
    std::size_t other = 0;
    std::size_t changes = 0;
    int failures = 0;
    const std::size_t before = allocation_count();
    for (std::size_t i = 0; i < 10000; i += case_step()) {
      float eye[3];
      for (float& e : eye) e = static_cast<float>(random() % 900) / 100.0f - 0.5f;
      sightcell_frame frame;
      failures += sightcell_view_move(view.get(), eye, &frame) != SIGHTCELL_OK;
      changes += frame.flags & SIGHTCELL_FRAME_CHANGED;
      failures += sightcell_view_polygons(view.get(), ids.data(), ids.size(), &count) != SIGHTCELL_OK;
      failures += sightcell_view_ranges(view.get(), ranges.data(), ranges.size(), &count) != SIGHTCELL_OK;
      failures +=
          sightcell_view_indices(view.get(), stored.data(), indices.data(), indices.size(), &count) != SIGHTCELL_OK;
      failures += sightcell_view_commands(view.get(), 4, commands.data(), sizeof(sightcell_command), commands.size(),
                                          &count) != SIGHTCELL_OK;
      const sightcell_status s = sightcell_view_changes(view.get(), frame.revision - 1, ranges.data(), ranges.size(),
                                                        &count, more.data(), more.size(), &other);
      failures += s != SIGHTCELL_OK && s != SIGHTCELL_ERR_STALE;
      row.swap(last_row);
      failures += sightcell_view_clusters(view.get(), map, row.data(), row.size()) != SIGHTCELL_OK;
      failures += sightcell_cluster_list(row.data(), row.size(), ids.data(), ids.size(), &count) != SIGHTCELL_OK;
      failures += sightcell_cluster_changes(last_row.data(), row.data(), row.size(), words.data(), words.size(),
                                            &count) != SIGHTCELL_OK;
    }
    EXPECT_EQ(allocation_count(), before);
    EXPECT_EQ(memory.given, 3u);
    sightcell_cluster_map_destroy(map);
    EXPECT_EQ(failures, 0);
    EXPECT_GT(changes, 5000u / case_step());
  }
  EXPECT_EQ(memory.bytes, 0u) << "every block was released with its size";
}

TEST(allocation, none_for_importance) {
  const sample_contents contents = random_contents(55, {.polygons = 3000, .draws = 40, .cells = 200});
  const loaded_file file(with_importance(contents.encode(), sample_class));
  test_view view(file.db());
  std::vector<float> by_draw(40);
  int failures = 0;
  const std::size_t before = allocation_count();
  for (const auto& cell : contents.cells) {
    static_cast<void>(view.move(cell.min[0], cell.min[1], cell.min[2]));
    std::size_t count = 0;
    failures += sightcell_view_importance(view.get(), by_draw.data(), by_draw.size(), &count) != SIGHTCELL_OK;
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(failures, 0);
}

TEST(allocation, none_for_a_paged_file) {
  sample_contents contents = random_contents(53, {.polygons = 3000, .draws = 40, .cells = 512});
  add_volumes(contents, 200, 53);
  const auto bytes = contents.encode();
  counting_allocator memory;
  {
    // A host that reads and delivers at once.
    struct reading_host {
      const std::vector<std::byte>& bytes;
      sightcell_db* db = nullptr;
    } host{bytes};
    const sightcell_source source{&host, bytes.size(),
                                  [](void* user, std::uint64_t offset, std::uint32_t size, std::uint32_t ticket) {
                                    const auto& self = *static_cast<reading_host*>(user);
                                    return sightcell_db_deliver(self.db, ticket, self.bytes.data() + offset, size);
                                  }};
    ASSERT_EQ(sightcell_db_open_source(&source, &memory.interface, 20'000, &host.db), SIGHTCELL_OK);
    EXPECT_EQ(memory.given, 3u) << "itself, the front of the file, tables";
    sightcell_view* view = nullptr;
    ASSERT_EQ(sightcell_view_create(host.db, &view), SIGHTCELL_OK);
    ASSERT_EQ(sightcell_view_policy(view, SIGHTCELL_OUTSIDE_NEAREST, 1.0f), SIGHTCELL_OK);
    std::vector<std::uint64_t> bits(1);
    std::vector<sightcell_debug_line> lines(20'000);
    std::vector<char> text(500);
    sightcell_view_stats of_view{};
    of_view.struct_size = sizeof of_view;
    sightcell_db_stats stats{};
    stats.struct_size = sizeof stats;
    random_source random(54);
    int failures = 0;
    std::uint32_t hidden = 0;
    const std::size_t before = allocation_count();
    for (std::size_t i = 0; i < 10000; i += case_step()) {
      float eye[3];
      float end[3];
      for (int axis = 0; axis < 3; ++axis) {
        eye[axis] = static_cast<float>(random() % 1000) / 100.0f - 1.0f;
        end[axis] = eye[axis] + static_cast<float>(random() % 100) / 100.0f;
      }
      sightcell_frame frame;
      const double origin[3] = {0.001 * static_cast<double>(i % 100), 0.0, 0.0};
      failures += sightcell_view_origin(view, origin) != SIGHTCELL_OK;
      failures += sightcell_view_move(view, eye, &frame) != SIGHTCELL_OK;
      failures += sightcell_view_move_box(view, eye, end, &frame) != SIGHTCELL_OK;
      failures += sightcell_view_objects(view, bits.data(), bits.size()) != SIGHTCELL_OK;
      std::uint32_t visible = 0;
      failures += sightcell_view_box_visible(view, eye, end, &visible) != SIGHTCELL_OK;
      hidden += 1 - visible;
      failures += sightcell_db_prefetch(host.db, eye, end, 1.0f) != SIGHTCELL_OK;
      std::size_t count = 0;
      failures += sightcell_view_debug_lines(view, 15, lines.data(), lines.size(), &count) != SIGHTCELL_OK;
      failures += sightcell_view_statistics(view, &of_view) != SIGHTCELL_OK;
      failures += sightcell_db_statistics(host.db, &stats) != SIGHTCELL_OK;
      const sightcell_miss miss{{1.0, 2.0, 3.0}, 7, 0};
      failures += sightcell_db_misses_text(host.db, &miss, 1, text.data(), text.size(), &count) != SIGHTCELL_OK;
    }
    EXPECT_EQ(allocation_count(), before);
    EXPECT_EQ(memory.given, 4u);
    EXPECT_EQ(failures, 0);
    EXPECT_GT(hidden, 0u);
    EXPECT_GT(stats.evictions, 100u / case_step());
    EXPECT_LE(stats.resident_bytes, 20'000u);
    sightcell_view_destroy(view);
    sightcell_db_close(host.db);
  }
  EXPECT_EQ(memory.bytes, 0u) << "every block was released with its size";
}

TEST(allocation, the_counter_counts) {
  if (!counts_new()) GTEST_SKIP() << "a sanitizer has its own allocator";
  const std::size_t before = allocation_count();
  auto* volatile number = new int(3);
  EXPECT_GT(allocation_count(), before);
  delete number;
  if (!counts_malloc()) return;
  const std::size_t then = allocation_count();
  void* volatile block = std::malloc(10);
  EXPECT_GT(allocation_count(), then);
  std::free(block);
}

}  // namespace
