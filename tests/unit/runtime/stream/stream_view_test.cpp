// Views: which cell they take, what they show while files are missing, and what may be removed.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#include "small_stream.h"

namespace {

using namespace sightcell::test;
using numbers = std::vector<std::uint32_t>;

constexpr std::uint32_t changed = SIGHTCELL_STREAM_CHANGED, outside = SIGHTCELL_STREAM_OUTSIDE,
                        pending = SIGHTCELL_STREAM_PENDING, unknown = SIGHTCELL_STREAM_UNKNOWN_CELL;

void load_all(const small_stream& content, const open_stream& scene) {
  for (std::uint32_t file = 0; file < content.image(1, 1); ++file) scene.load(file);
}

TEST(stream_view, takes_the_smallest_cell_that_contains_the_eye) {
  small_stream content = four_rooms();
  content.chunks[1].push_back({9, {1, 1, 1, 3, 3, 3}, {}, {}, {}});
  content.chunks[0].push_back({8, {2, 1, 1, 4, 3, 3}, {}, {}, {}});  // as large as 9
  open_stream scene(content);
  load_all(content, scene);
  EXPECT_EQ(scene.move(0, 0, 0).cell, 0u);
  EXPECT_EQ(scene.move(1, 1, 1).cell, 9u);
  EXPECT_EQ(scene.move(2.5f, 2, 2).cell, 8u) << "of equal ones the lowest number";
  EXPECT_EQ(scene.move(2.5f, 3, 2).cell, 0u) << "the maximum is outside";
  EXPECT_EQ(scene.move(10, 5, 5).cell, 1u);
}

TEST(stream_view, outside_all_cells_it_keeps_its_cell) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  scene.load(0);
  EXPECT_EQ(scene.move(-5, 5, 5).cell, 0u) << "at first the nearest one";
  EXPECT_EQ(scene.move(12, 5, 5).flags & outside, 0u);
  const sightcell_stream_frame frame = scene.move(12, 50, 5);
  EXPECT_EQ(frame.cell, 1u);
  EXPECT_EQ(frame.flags & (outside | unknown), outside);
}

TEST(stream_view, without_its_chunk_the_cell_is_unknown) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  sightcell_stream_frame frame = scene.move(25, 5, 5);
  EXPECT_EQ(frame.flags, changed | outside | pending | unknown);
  EXPECT_EQ(frame.cell, SIGHTCELL_NO_CELL);
  EXPECT_EQ(scene.requested_files(), numbers{1});
  EXPECT_EQ(scene.draws(), numbers{});
  scene.load(1);
  frame = scene.move(25, 5, 5);
  EXPECT_EQ(frame.cell, 2u);
  EXPECT_EQ(frame.flags, changed | pending);
  frame = scene.move(5, 5, 5);
  EXPECT_EQ(frame.cell, 2u) << "until the chunk of the eye is there";
  EXPECT_EQ(frame.flags, outside | pending | unknown);
  scene.set(0, SIGHTCELL_STREAM_FAILED);
  EXPECT_EQ(scene.move(5, 5, 5).flags, outside | pending) << "nothing to wait for";
}

TEST(stream_view, far_away_it_asks_for_the_nearest_chunk) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  EXPECT_EQ(scene.move(100, 5, 5).flags & unknown, unknown);
  EXPECT_EQ(scene.requested_files(), numbers{1});
  scene.load(1);
  EXPECT_EQ(scene.move(100, 5, 5).cell, 3u);
}

TEST(stream_view, shows_the_last_complete_cell_until_the_next_one_is_complete) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  for (const std::uint32_t file : {0u, 1u, content.page(0), content.image(0)}) scene.load(file);
  sightcell_stream_frame frame = scene.move(5, 5, 5);
  EXPECT_EQ(frame.flags, changed);
  EXPECT_EQ(frame.complete_cell, 0u);
  EXPECT_EQ(scene.draws(), numbers{0});

  frame = scene.move(35, 5, 5);
  EXPECT_EQ(frame.flags, changed | pending);
  EXPECT_EQ(frame.missing, 3u) << "two pages and an image";
  EXPECT_EQ(frame.complete_cell, 0u);
  EXPECT_EQ(scene.draws(), (numbers{0, 2, 3}));
  EXPECT_EQ(scene.move(35, 5, 5).flags, pending) << "nothing new to show";
  scene.load(content.page(2));
  scene.load(content.page(3));
  EXPECT_EQ(scene.move(35, 5, 5).missing, 1u);
  scene.set(content.image(1), SIGHTCELL_STREAM_FAILED);
  frame = scene.move(35, 5, 5);
  EXPECT_EQ(frame.flags, changed);
  EXPECT_EQ(frame.complete_cell, 3u);
  EXPECT_EQ(scene.draws(), (numbers{2, 3}));
}

TEST(stream_view, one_version_of_an_image_is_enough_and_failed_pages_are_counted) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  scene.load(0);
  scene.load(content.image(0, 1));
  scene.set(content.page(0), SIGHTCELL_STREAM_FAILED);
  const sightcell_stream_frame frame = scene.move(5, 5, 5);
  EXPECT_EQ(frame.flags, changed);
  EXPECT_EQ(frame.failed, 1u);
  EXPECT_EQ(frame.weight, 4.0f);
  EXPECT_EQ(frame.weight_present, 0.0f);
}

TEST(stream_view, files_that_every_cell_needs_and_draws_that_are_in_every_cell) {
  small_stream content = four_rooms();
  content.draws[4].flags = SIGHTCELL_STREAM_MOVES | SIGHTCELL_STREAM_ALWAYS;
  content.pages_everywhere = {3};
  content.images_everywhere = {1};
  open_stream scene(content);
  EXPECT_EQ(scene.move(5, 5, 5).missing, 2u);
  EXPECT_EQ(scene.draws(), numbers{4});
  EXPECT_EQ(scene.requested_files(), (numbers{0, content.page(3), content.image(1)}));
  for (const std::uint32_t file : scene.requested_files()) scene.load(file);
  EXPECT_EQ(scene.move(5, 5, 5).missing, 2u) << "those of the cell";
  EXPECT_EQ(scene.draws(), (numbers{0, 4}));
  EXPECT_EQ(scene.removable(), numbers{});
}

TEST(stream_view, sums_of_weights) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  scene.load(0);
  scene.load(content.page(0));
  const sightcell_stream_frame frame = scene.move(15, 5, 5);
  EXPECT_FLOAT_EQ(frame.weight, 5.0f) << "4 and a quarter of it, 2^(-16 / 8)";
  EXPECT_FLOAT_EQ(frame.weight_present, 1.0f);
}

TEST(stream_view, a_pose_that_is_not_finite_changes_nothing) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  scene.load(0);
  ASSERT_EQ(scene.move(5, 5, 5).cell, 0u);
  sightcell_stream_frame frame{};
  frame.cell = 77;
  for (std::size_t at = 0; at < sizeof(sightcell_stream_pose) / sizeof(float); ++at) {
    sightcell_stream_pose pose{};
    reinterpret_cast<float*>(&pose)[at] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(sightcell_stream_view_move(scene.view, &pose, &frame), SIGHTCELL_ERR_ARGUMENT) << at;
  }
  EXPECT_EQ(frame.cell, 77u);
}

TEST(stream_files, removable_are_those_that_no_view_needs_the_oldest_first) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  load_all(content, scene);
  static_cast<void>(scene.move(5, 5, 5));
  static_cast<void>(scene.move(15, 5, 5));
  static_cast<void>(scene.move(35, 5, 5));  // needs pages 2 and 3 and image 1
  const numbers all = scene.removable();
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[4], content.image(0, 2)) << "page 0, page 1 and image 0 were in the cell before";
  EXPECT_EQ(std::count(all.begin(), all.end(), content.page(0)), 1);
  for (std::size_t capacity = 0; capacity <= 5; ++capacity)
    EXPECT_EQ(scene.removable(capacity), numbers(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(capacity)));

  sightcell_stream_view* other = nullptr;
  ASSERT_EQ(sightcell_stream_view_create(scene.stream, &other), SIGHTCELL_OK);
  sightcell_stream_pose pose{};
  pose.eye[0] = pose.eye[1] = pose.eye[2] = 5;
  sightcell_stream_frame frame;
  ASSERT_EQ(sightcell_stream_view_move(other, &pose, &frame), SIGHTCELL_OK);
  EXPECT_EQ(scene.removable(), numbers{content.page(1)});
  sightcell_stream_view_destroy(other);
  EXPECT_EQ(scene.removable().size(), 5u);
  EXPECT_EQ(scene.removable().front(), content.page(1));
}

TEST(stream_files, what_a_pending_view_still_shows_stays) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  for (const std::uint32_t file : {0u, 1u, content.page(0), content.image(0)}) scene.load(file);
  static_cast<void>(scene.move(5, 5, 5));
  static_cast<void>(scene.move(35, 5, 5));
  EXPECT_EQ(scene.removable(), numbers{});
}

TEST(stream_files, chunks_beyond_the_limit_go_the_least_recent_first) {
  small_stream content;
  content.add_draw();
  for (std::uint32_t i = 0; i < 6; ++i) {
    const auto x = static_cast<float>(10 * i);
    content.chunks.push_back({{i, {x, 0, 0, x + 10, 10, 10}, {}, {{0, 1}}, {}}});
  }
  open_stream scene(content, 1);  // a byte: only what is used, and the newest one
  const auto present = [&] {
    numbers out;
    for (std::uint32_t i = 0; i < 6; ++i)
      if (sightcell_stream_state(scene.stream, i) == SIGHTCELL_STREAM_PRESENT) out.push_back(i);
    return out;
  };
  scene.load(0);
  EXPECT_EQ(scene.move(5, 5, 5).cell, 0u);
  scene.load(3);
  scene.load(5);
  EXPECT_EQ(present(), (numbers{0, 5}));
  EXPECT_EQ(scene.move(35, 5, 5).cell, 0u);
  EXPECT_EQ(scene.requested_files(), numbers{3});
  scene.load(3);
  EXPECT_EQ(scene.move(35, 5, 5).cell, 3u);
  scene.load(1);
  EXPECT_EQ(present(), (numbers{1, 3}));
  EXPECT_EQ(sightcell_stream_set_state(scene.stream, 3, SIGHTCELL_STREAM_ABSENT), SIGHTCELL_ERR_ARGUMENT);
}

TEST(stream_files, states_are_the_hosts) {
  const small_stream content = four_rooms();
  const open_stream scene(content);
  const std::uint32_t page = content.page(0);
  const bytes file = content.file(page);
  ASSERT_EQ(sightcell_stream_deliver(scene.stream, page, file.data(), file.size()), SIGHTCELL_OK);
  EXPECT_EQ(sightcell_stream_state(scene.stream, page), std::uint32_t{SIGHTCELL_STREAM_REQUESTED});
  scene.set(page, SIGHTCELL_STREAM_PRESENT);
  ASSERT_EQ(sightcell_stream_deliver(scene.stream, page, file.data(), file.size()), SIGHTCELL_OK);
  EXPECT_EQ(sightcell_stream_state(scene.stream, page), std::uint32_t{SIGHTCELL_STREAM_PRESENT});
  EXPECT_EQ(sightcell_stream_set_state(scene.stream, page, 4), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_stream_set_state(scene.stream, 10, 0), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_stream_set_state(scene.stream, 0, SIGHTCELL_STREAM_PRESENT), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_stream_state(nullptr, 0), std::uint32_t{SIGHTCELL_STREAM_ABSENT});
}

TEST(stream_files, a_frame_does_not_allocate) {
  struct counter {
    std::atomic<int> calls{0};
  } memory;
  const sightcell_allocator mem{[](void* user, std::size_t size, std::size_t) -> void* {
                                  ++static_cast<counter*>(user)->calls;
                                  return std::malloc(size);
                                },
                                [](void* user, void* block, std::size_t) {
                                  ++static_cast<counter*>(user)->calls;
                                  std::free(block);
                                },
                                &memory};
  const small_stream content = four_rooms();
  open_stream scene(content, 1 << 20, &mem);
  load_all(content, scene);
  const int before = memory.calls;
  sightcell_stream_request requests[8];
  std::uint32_t files[8];
  std::uint64_t bits = 0;
  std::size_t count = 0;
  for (int step = 0; step < 400; ++step) {
    static_cast<void>(scene.move(0.1f * static_cast<float>(step), 5, 5));
    EXPECT_EQ(sightcell_stream_view_requests(scene.view, 2.0f, requests, 8, &count), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_stream_view_draws(scene.view, &bits, 1), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_stream_removable(scene.stream, files, 8, &count), SIGHTCELL_OK);
  }
  EXPECT_EQ(memory.calls, before);
}

TEST(stream_files, threads_deliver_while_views_move) {
  const small_stream content = four_rooms();
  const bytes front = content.front();
  sightcell_stream* stream = nullptr;
  ASSERT_EQ(sightcell_stream_open(front.data(), front.size(), 1, nullptr, &stream), SIGHTCELL_OK);
  std::vector<std::thread> threads;
  for (unsigned loader = 0; loader < 2; ++loader)
    threads.emplace_back([&, loader] {
      for (std::uint32_t i = 0; i < 600; ++i) {
        const std::uint32_t file = (i * 7 + loader) % 10;
        const bytes contents = content.file(file);
        EXPECT_EQ(sightcell_stream_deliver(stream, file, contents.data(), contents.size()), SIGHTCELL_OK);
        if (file < 2) continue;
        EXPECT_EQ(
            sightcell_stream_set_state(stream, file, i % 3 == 0 ? SIGHTCELL_STREAM_ABSENT : SIGHTCELL_STREAM_PRESENT),
            SIGHTCELL_OK);
      }
    });
  for (unsigned camera = 0; camera < 2; ++camera)
    threads.emplace_back([&, camera] {
      sightcell_stream_view* view = nullptr;
      ASSERT_EQ(sightcell_stream_view_create(stream, &view), SIGHTCELL_OK);
      for (int i = 0; i < 600; ++i) {
        sightcell_stream_pose pose{};
        pose.eye[0] = static_cast<float>((i * 13 + static_cast<int>(camera)) % 40);
        pose.eye[1] = pose.eye[2] = 5;
        sightcell_stream_frame frame;
        sightcell_stream_request requests[8];
        std::uint32_t files[4];
        std::size_t count = 0;
        std::uint64_t bits = 0;
        EXPECT_EQ(sightcell_stream_view_move(view, &pose, &frame), SIGHTCELL_OK);
        EXPECT_EQ(sightcell_stream_view_requests(view, 1.0f, requests, 8, &count), SIGHTCELL_OK);
        EXPECT_EQ(sightcell_stream_view_draws(view, &bits, 1), SIGHTCELL_OK);
        EXPECT_EQ(sightcell_stream_removable(stream, files, 4, &count), SIGHTCELL_OK);
      }
      sightcell_stream_view_destroy(view);
    });
  for (std::thread& thread : threads) thread.join();
  sightcell_stream_close(stream);
}

}  // namespace
