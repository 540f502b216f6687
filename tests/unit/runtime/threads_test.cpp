// One db, eight views on eight threads, for the thread sanitizer. All threads use unchecked chunks at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "loaded_file.h"
#include "paged_host.h"
#include "sightcell/clusters.h"
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
  const std::vector<std::uint32_t> one_each = all_polygons(500);  // a cluster per polygon
  sightcell_cluster_map* map = nullptr;
  ASSERT_EQ(sightcell_cluster_map_create(file.db(), one_each.data(), 500, 500, &map), SIGHTCELL_OK);
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
        std::array<std::uint32_t, 16> row;
        if (sightcell_view_clusters(view, map, row.data(), row.size()) != SIGHTCELL_OK) ++wrong;
        if (sightcell_cluster_list(row.data(), row.size(), nullptr, 0, &count) == SIGHTCELL_ERR_ARGUMENT) ++wrong;
        if (count != expected) ++wrong;
      }
      sightcell_view_destroy(view);
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong.load(), 0);
  sightcell_cluster_map_destroy(map);
}

// Two threads of the host deliver rows, in their own order, to eight views and a ninth thread that prefetches; there is
// room for three chunks of eight.
TEST(threads, eight_views_of_a_paged_file) {
  const sample_contents contents = random_contents(62, {.polygons = 500, .draws = 20, .cells = 512});
  const auto bytes = contents.encode();
  struct reading_host {
    const std::vector<std::byte>& bytes;
    sightcell_db* db = nullptr;
    bool at_once = true;
    std::mutex mutex{};
    std::condition_variable news{};  // of the two below
    std::vector<page_request> waiting{};
    bool over = false;
  } host{.bytes = bytes};
  const sightcell_source source{&host, bytes.size(),
                                [](void* user, std::uint64_t offset, std::uint32_t size, std::uint32_t ticket) {
                                  auto& self = *static_cast<reading_host*>(user);
                                  if (self.at_once) {
                                    return sightcell_db_deliver(self.db, ticket, self.bytes.data() + offset, size);
                                  }
                                  {
                                    const std::lock_guard guard(self.mutex);
                                    self.waiting.push_back({offset, size, ticket});
                                  }
                                  self.news.notify_one();
                                  return SIGHTCELL_OK;
                                }};
  std::uint64_t room = 0;
  const std::size_t directory = section_offset(bytes, sightcell::format::layout::section_row_directory);
  for (std::size_t chunk = 0; chunk < 3; ++chunk) room += get_u32(bytes, directory + 16 * chunk + 8);
  ASSERT_EQ(sightcell_db_open_source(&source, nullptr, room, &host.db), SIGHTCELL_OK);
  host.at_once = false;

  const auto read = [&](std::uint32_t seed) {
    random_source random(seed);
    for (;;) {
      page_request r;
      {
        std::unique_lock guard(host.mutex);
        host.news.wait(guard, [&] { return !host.waiting.empty() || host.over; });
        if (host.waiting.empty()) return;
        const std::size_t which = random() % host.waiting.size();
        r = host.waiting[which];
        host.waiting.erase(host.waiting.begin() + static_cast<std::ptrdiff_t>(which));
      }
      static_cast<void>(sightcell_db_deliver(host.db, r.ticket, bytes.data() + r.offset, r.size));
    }
  };
  std::thread first_reader(read, 63);
  std::thread second_reader(read, 64);
  std::atomic<int> wrong{0};
  std::atomic<int> shown{0};
  std::vector<std::thread> threads;
  for (std::uint32_t number = 0; number < 8; ++number) {
    threads.emplace_back([&, number] {
      random_source random(number);
      sightcell_view* view = nullptr;
      if (sightcell_view_create(host.db, &view) != SIGHTCELL_OK) ++wrong;
      std::vector<std::uint32_t> ids(500);
      for (int i = 0; i < 200; ++i) {
        const std::uint32_t cell = random() % 512;
        const auto& b = contents.cells[cell];
        const float eye[3] = {b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f};
        for (int frames = 0; frames < 1'000'000; ++frames) {  // the reader may be slow
          sightcell_frame frame;
          std::size_t count = 0;
          if (sightcell_view_move(view, eye, &frame) != SIGHTCELL_OK || frame.cell != cell) ++wrong;
          if (sightcell_view_polygons(view, ids.data(), ids.size(), &count) != SIGHTCELL_OK) ++wrong;
          const bool pending = (frame.flags & SIGHTCELL_FRAME_PENDING) != 0;
          if (count != (pending ? 500 : contents.sets[cell].size())) ++wrong;
          if (pending) {
            std::this_thread::yield();
            continue;
          }
          if (!std::equal(contents.sets[cell].begin(), contents.sets[cell].end(), ids.begin())) ++wrong;
          ++shown;
          break;
        }
      }
      sightcell_view_destroy(view);
    });
  }
  threads.emplace_back([&] {
    for (int i = 0; i < 500; ++i) {
      const float eye[3] = {static_cast<float>(i % 8), static_cast<float>(i / 8 % 8), 4.0f};
      const float velocity[3] = {1.0f, 0.5f, -2.0f};
      if (sightcell_db_prefetch(host.db, eye, velocity, 1.0f) != SIGHTCELL_OK) ++wrong;
    }
  });
  for (std::thread& t : threads) t.join();
  {
    const std::lock_guard guard(host.mutex);
    host.over = true;
  }
  host.news.notify_all();
  first_reader.join();
  second_reader.join();
  EXPECT_EQ(wrong.load(), 0);
  EXPECT_EQ(shown.load(), 8 * 200) << "each camera gets its chunks, whatever the others request";
  sightcell_db_close(host.db);
}

// Two chunks are delivered at the same moment, and there is room for one.
TEST(threads, deliveries_at_once) {
  const sample_contents contents =
      random_contents(64, {.polygons = 3000, .draws = 20, .cells = 512, .visible = 0.3, .changed = 0.5});
  paged_host host(contents.encode());
  std::uint32_t largest = 0;
  const std::size_t directory = section_offset(host.bytes(), sightcell::format::layout::section_row_directory);
  for (std::size_t chunk = 0; chunk < 8; ++chunk) {
    largest = std::max(largest, get_u32(host.bytes(), directory + 16 * chunk + 8));
  }
  ASSERT_EQ(host.open(largest), SIGHTCELL_OK);
  test_view first(host.db());
  test_view second(host.db());
  const auto is_right = [&](test_view& view, std::uint32_t cell) {
    const auto& b = contents.cells[cell];
    const sightcell_frame frame = view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f);
    if ((frame.flags & SIGHTCELL_FRAME_PENDING) != 0) return true;
    return (frame.flags & SIGHTCELL_FRAME_DAMAGED) == 0 && view.polygons() == contents.sets[cell];
  };
  const auto is_fine = [](sightcell_status s) { return s == SIGHTCELL_OK || s == SIGHTCELL_ERR_CAPACITY; };
  random_source random(65);
  int at_once = 0;
  for (int round = 0; round < 1000; ++round) {
    const std::uint32_t cells[2] = {random() % 512, random() % 512};
    ASSERT_TRUE(is_right(first, cells[0]) && is_right(second, cells[1])) << "round " << round;
    if (host.waiting.size() == 2) {
      std::atomic<bool> go{false};
      sightcell_status other = SIGHTCELL_OK;
      std::thread reader([&] {
        while (!go) std::this_thread::yield();
        other = host.deliver(host.waiting[1]);
      });
      go = true;
      EXPECT_TRUE(is_fine(host.deliver(host.waiting[0])));
      reader.join();
      EXPECT_TRUE(is_fine(other));
      host.waiting.clear();
      ++at_once;
      ASSERT_TRUE(is_right(first, cells[0]) && is_right(second, cells[1])) << "round " << round;
    }
    for (; !host.waiting.empty(); host.waiting.pop_front()) EXPECT_TRUE(is_fine(host.deliver(host.waiting.front())));
  }
  EXPECT_GT(at_once, 100);
}

}  // namespace
