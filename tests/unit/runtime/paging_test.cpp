// Paged files: what is requested, delivered and evicted, and the mistakes of a host.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <thread>

#include "loaded_file.h"
#include "paged_host.h"
#include "sightcell/format/cell_lattice.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;

constexpr std::uint32_t pending = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_PENDING;
constexpr std::uint32_t damaged = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED;
constexpr std::uint32_t shown = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_PENDING | SIGHTCELL_FRAME_DAMAGED;

sample_contents eight_chunks() {
  return random_contents(91, {.polygons = 900, .draws = 20, .cells = 512});
}

std::vector<std::uint32_t> chunk_sizes(const sample_contents& contents) {
  const auto bytes = contents.encode();
  const std::size_t directory = section_offset(bytes, 4);
  std::vector<std::uint32_t> sizes;
  for (std::size_t chunk = 0; chunk < chunks_of(bytes); ++chunk) {
    sizes.push_back(get_u32(bytes, directory + 16 * chunk + 8));
  }
  return sizes;
}

std::uint64_t largest(const sample_contents& contents) {
  const auto sizes = chunk_sizes(contents);
  return *std::max_element(sizes.begin(), sizes.end());
}

sightcell_frame go_to(test_view& view, const sample_contents& contents, std::uint32_t cell) {
  const auto& b = contents.cells[cell];
  return view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2);
}

TEST(paging, same_sets_as_from_memory_with_room_for_one_chunk) {
  for (const int kind : {0, 1, 2}) {
    sample_contents contents = eight_chunks();
    if (kind == 1) {
      put_on_lattice(contents);
      contents.chunk_bytes = 500;
    }
    if (kind == 2) put_in_groups(contents, 3);
    paged_host host(contents.encode());
    host.at_once = true;
    ASSERT_EQ(host.open(largest(contents)), SIGHTCELL_OK);
    EXPECT_EQ(host.opening_requests, 2u);
    const loaded_file file(contents);
    test_view paged(host.db());
    test_view whole(file.db());
    random_source random(92);
    for (int step = 0; step < 2000; ++step) {
      const std::uint32_t cell = random() % 512;
      const sightcell_frame frame = go_to(paged, contents, cell);
      ASSERT_EQ(frame.flags, go_to(whole, contents, cell).flags);
      ASSERT_EQ(paged.polygons(), whole.polygons());
      ASSERT_EQ(frame.cell, cell);
    }
    EXPECT_GT(host.requests, 1000u) << "a chunk at a time";
  }
}

TEST(paging, with_room_for_all_each_chunk_is_requested_once) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  host.at_once = true;
  ASSERT_EQ(host.open(1 << 30), SIGHTCELL_OK);
  test_view view(host.db());
  for (std::uint32_t step = 0; step < 3000; ++step) static_cast<void>(go_to(view, contents, step * 37 % 512));
  EXPECT_EQ(host.requests, 8u);
}

TEST(paging, draws_all_until_the_chunk_is_delivered) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  EXPECT_EQ(go_to(view, contents, 70).flags, SIGHTCELL_FRAME_CHANGED | pending);
  EXPECT_EQ(view.polygons().size(), 900u);
  EXPECT_EQ(go_to(view, contents, 70).flags, pending);
  EXPECT_EQ(go_to(view, contents, 71).flags, pending);
  EXPECT_EQ(host.requests, 1u) << "requested once";
  host.deliver_all();
  EXPECT_EQ(go_to(view, contents, 71).flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_CHANGED));
  EXPECT_EQ(view.polygons(), contents.sets[71]);
  EXPECT_EQ(go_to(view, contents, 70).flags & shown, 0u);
  EXPECT_EQ(host.requests, 1u);
}

// Goes to a cell whose chunk is there, then to one whose chunk is not.
TEST(paging, a_policy_keeps_the_last_set_until_the_chunk_is_delivered) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  constexpr std::uint32_t kept = SIGHTCELL_FRAME_PENDING;
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST | SIGHTCELL_PENDING_LAST, 1e6f), SIGHTCELL_OK);
  EXPECT_EQ(go_to(view, contents, 70).flags, SIGHTCELL_FRAME_CHANGED | pending) << "no set was shown before";
  host.deliver_all();
  EXPECT_EQ(go_to(view, contents, 70).flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_CHANGED));
  EXPECT_EQ(go_to(view, contents, 200).flags, kept);
  EXPECT_EQ(view.polygons(), contents.sets[70]);
  EXPECT_EQ(go_to(view, contents, 200).cell, 200u);
  EXPECT_EQ(go_to(view, contents, 300).flags, kept);
  EXPECT_EQ(view.polygons(), contents.sets[70]);
  EXPECT_EQ(go_to(view, contents, 70).flags, 0u) << "its set is still shown";
  EXPECT_EQ(go_to(view, contents, 200).flags, kept);
  host.deliver_all();
  EXPECT_EQ(go_to(view, contents, 200).flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_CHANGED));
  EXPECT_EQ(view.polygons(), contents.sets[200]);
  EXPECT_EQ(go_to(view, contents, 300).flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_CHANGED))
      << "requested before";
  EXPECT_EQ(view.polygons(), contents.sets[300]);
}

TEST(paging, the_last_set_is_kept_up_to_a_distance_and_for_boxes) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  static_cast<void>(go_to(view, contents, 0));
  host.deliver_all();
  ASSERT_EQ(go_to(view, contents, 0).flags & shown, 0u);
  const float min[3] = {1.5f, 1.5f, 1.5f};
  const float max[3] = {3.5f, 3.5f, 3.5f};
  sightcell_frame frame;
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_PENDING_LAST, 1e6f), SIGHTCELL_OK);
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(frame.flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_PENDING));
  EXPECT_EQ(view.polygons(), contents.sets[0]);
  EXPECT_GT(host.waiting.size(), 1u) << "all chunks are requested";
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_PENDING_LAST, 0.1f), SIGHTCELL_OK);
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_CHANGED | pending) << "too far from the cell whose set was shown";
  host.deliver_all();
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(frame.flags & shown, 0u);
}

TEST(paging, a_box_requests_all_its_chunks) {
  sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  const test_view view(host.db());
  const float min[3] = {1.5f, 1.5f, 1.5f};
  const float max[3] = {3.5f, 3.5f, 3.5f};
  sightcell_frame frame;
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(frame.flags & shown, pending);
  EXPECT_GT(host.requests, 1u);
  const std::size_t asked = host.requests;
  host.deliver_all();
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(frame.flags & shown, 0u);
  EXPECT_EQ(host.requests, asked);
}

// Chunks of the same size, so that any can replace any other.
TEST(paging, the_least_recently_used_chunk_is_evicted_first) {
  sample_contents contents = eight_chunks();
  for (std::uint32_t i = 0; i < contents.sets.size(); ++i) contents.sets[i] = {i % 64, 100 + i % 64 * 3};
  const auto sizes = chunk_sizes(contents);
  ASSERT_EQ(std::count(sizes.begin(), sizes.end(), sizes[0]), 8);
  for (const std::uint32_t oldest : {0u, 1u, 2u}) {
    paged_host host(contents.encode());
    host.at_once = true;
    ASSERT_EQ(host.open(std::uint64_t{3} * sizes[0]), SIGHTCELL_OK);
    test_view view(host.db());
    for (const std::uint32_t chunk : {0u, 1u, 2u}) static_cast<void>(go_to(view, contents, 64 * chunk));
    for (const std::uint32_t chunk : {0u, 1u, 2u}) {
      if (chunk != oldest) static_cast<void>(go_to(view, contents, 64 * chunk + 1));
    }
    EXPECT_EQ(host.requests, 3u);
    static_cast<void>(go_to(view, contents, 64 * 3));
    EXPECT_EQ(host.requests, 4u);
    for (const std::uint32_t chunk : {0u, 1u, 2u}) {
      if (chunk != oldest) static_cast<void>(go_to(view, contents, 64 * chunk + 2));
    }
    EXPECT_EQ(host.requests, 4u) << "those that were used later are still resident";
    static_cast<void>(go_to(view, contents, 64 * oldest));
    EXPECT_EQ(host.requests, 5u);
  }
}

TEST(paging, late_and_doubled_deliveries) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  static_cast<void>(go_to(view, contents, 0));
  static_cast<void>(go_to(view, contents, 100));  // the camera has moved on
  ASSERT_EQ(host.waiting.size(), 2u);
  const page_request first = host.waiting[0];
  const page_request second = host.waiting[1];
  EXPECT_EQ(host.deliver(second), SIGHTCELL_OK) << "in any order";
  EXPECT_EQ(host.deliver(second), SIGHTCELL_ERR_STALE);
  EXPECT_EQ(go_to(view, contents, 100).flags & shown, 0u);
  EXPECT_EQ(host.deliver(first), SIGHTCELL_OK) << "late, but there is room";
  EXPECT_EQ(host.deliver(first), SIGHTCELL_ERR_STALE);
  EXPECT_EQ(sightcell_db_deliver(host.db(), 12345, host.bytes().data(), 10), SIGHTCELL_ERR_STALE);
  EXPECT_EQ(go_to(view, contents, 0).flags & shown, 0u);
  EXPECT_EQ(view.polygons(), contents.sets[0]);
}

TEST(paging, a_late_delivery_takes_the_room_of_nothing_newer) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(largest(contents)), SIGHTCELL_OK);
  test_view view(host.db());
  static_cast<void>(go_to(view, contents, 0));
  static_cast<void>(go_to(view, contents, 100));
  const page_request late = host.waiting[0];
  EXPECT_EQ(host.deliver(host.waiting[1]), SIGHTCELL_OK);
  EXPECT_EQ(host.deliver(late), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(go_to(view, contents, 100).flags & shown, 0u);
  host.waiting.clear();
  EXPECT_EQ(go_to(view, contents, 0).flags & shown, pending) << "and it is requested again";
  host.deliver_all();
  EXPECT_EQ(go_to(view, contents, 0).flags & shown, 0u);
}

TEST(paging, wrong_sizes_and_unreadable_bytes_are_requested_again) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  const auto ask = [&] {
    EXPECT_EQ(go_to(view, contents, 5).flags & shown, pending);
    EXPECT_EQ(host.waiting.size(), 1u);
    const page_request r = host.waiting.front();
    host.waiting.pop_front();
    return r;
  };
  page_request r = ask();
  EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, host.bytes().data() + r.offset, r.size - 1),
            SIGHTCELL_ERR_TRUNCATED);
  r = ask();
  EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, host.bytes().data() + r.offset, r.size + 1),
            SIGHTCELL_ERR_CORRUPT);
  r = ask();
  EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, nullptr, 0), SIGHTCELL_OK);
  host.answer = SIGHTCELL_ERR_IO;
  EXPECT_EQ(go_to(view, contents, 5).flags & shown, pending) << "the host returns an error";
  host.answer = SIGHTCELL_OK;
  r = ask();
  EXPECT_EQ(host.deliver(r), SIGHTCELL_OK);
  EXPECT_EQ(go_to(view, contents, 5).flags & shown, 0u);
  EXPECT_EQ(view.polygons(), contents.sets[5]);
}

TEST(paging, damaged_bytes_cost_their_cells_their_culling) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  static_cast<void>(go_to(view, contents, 5));
  const page_request r = host.waiting.front();
  host.waiting.clear();
  std::vector<std::byte> bytes(host.bytes().begin() + static_cast<std::ptrdiff_t>(r.offset),
                               host.bytes().begin() + static_cast<std::ptrdiff_t>(r.offset + r.size));
  bytes[r.size / 2] ^= std::byte{64};
  EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, bytes.data(), r.size), SIGHTCELL_ERR_CHECKSUM);
  EXPECT_EQ(go_to(view, contents, 5).flags & shown, damaged);
  EXPECT_EQ(go_to(view, contents, 6).flags & shown, damaged);
  EXPECT_EQ(view.polygons().size(), 900u);
  EXPECT_TRUE(host.waiting.empty()) << "not requested again";
  static_cast<void>(go_to(view, contents, 64));
  host.deliver_all();
  EXPECT_EQ(go_to(view, contents, 64).flags & shown, 0u);
}

TEST(paging, of_many_requests_the_oldest_are_given_up) {
  const sample_contents contents = random_contents(93, {.polygons = 50, .draws = 2, .cells = 80 * 64});
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 24), SIGHTCELL_OK);
  test_view view(host.db());
  for (std::uint32_t chunk = 0; chunk < 80; ++chunk) static_cast<void>(go_to(view, contents, 64 * chunk));
  ASSERT_EQ(host.waiting.size(), 80u);
  for (std::uint32_t chunk = 0; chunk < 80; ++chunk) {
    EXPECT_EQ(host.deliver(host.waiting[chunk]), chunk < 16 ? SIGHTCELL_ERR_STALE : SIGHTCELL_OK);
  }
  host.waiting.clear();
  EXPECT_EQ(go_to(view, contents, 0).flags & shown, pending);
  host.deliver_all();
  EXPECT_EQ(go_to(view, contents, 0).flags & shown, 0u);
}

// 80 cells of 1 m in a row of 1,280 m of empty cells: one chunk every 64 m.
sample_contents long_street() {
  sample_contents contents = random_contents(94, {.polygons = 400, .draws = 4, .cells = 20 * 64});
  for (std::uint32_t i = 0; i < contents.cells.size(); ++i) {
    const auto x = static_cast<float>(i);
    contents.cells[i] = {{x, 0, 0}, {x + 1, 2, 4}};
  }
  return contents;
}

TEST(paging, prefetch_requests_the_path_ahead_nearest_first) {
  const sample_contents contents = long_street();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  const float eye[3] = {100, 1, 2};
  const float velocity[3] = {50, 0, 0};
  ASSERT_EQ(sightcell_db_prefetch(host.db(), eye, velocity, 4.0f), SIGHTCELL_OK);
  const auto sizes = chunk_sizes(contents);
  std::vector<std::uint64_t> begins{section_offset(host.bytes(), 3)};
  for (const std::uint32_t size : sizes) begins.push_back(begins.back() + size);
  std::vector<std::size_t> chunks;
  for (const page_request& r : host.waiting) {
    chunks.push_back(static_cast<std::size_t>(std::find(begins.begin(), begins.end(), r.offset) - begins.begin()));
  }
  // At 100 m is chunk 1. In four seconds the camera is at 300 m, plus or minus 100 m: the chunks on its path and at 200
  // m to 400 m.
  ASSERT_GE(chunks.size(), 5u);
  EXPECT_EQ(chunks[0], 1u);
  EXPECT_EQ(chunks[1], 2u) << "then the next one ahead";
  for (const std::size_t wanted : {3u, 4u, 5u})
    EXPECT_TRUE(std::find(chunks.begin(), chunks.end(), wanted) != chunks.end());
  EXPECT_TRUE(std::find(chunks.begin(), chunks.end(), 8u) == chunks.end()) << "beyond the path";
  const std::size_t asked = host.requests;
  ASSERT_EQ(sightcell_db_prefetch(host.db(), eye, velocity, 4.0f), SIGHTCELL_OK);
  EXPECT_EQ(host.requests, asked) << "they are requested already";
}

// 8 x 8 cells on a lattice, each a chunk of its own: the index has them as one group.
TEST(paging, prefetch_requests_the_small_chunks_on_its_path_only) {
  sample_contents contents = random_contents(95, {.polygons = 400, .draws = 4, .cells = 64});
  contents.lattice = sightcell::format::lattice_shape{4.0, 2.0};
  for (std::int32_t cell = 0; cell < 64; ++cell) {
    contents.places.push_back({cell % 8, 0, cell / 8, 0});
    contents.cells[static_cast<std::size_t>(cell)] =
        sightcell::format::box_of(*contents.lattice, contents.places.back());
  }
  contents.chunk_bytes = 1;
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  ASSERT_EQ(chunk_sizes(contents).size(), 64u);
  const auto& begin = contents.cells[0];
  const float eye[3] = {(begin.min[0] + begin.max[0]) / 2, (begin.min[1] + begin.max[1]) / 2,
                        (begin.min[2] + begin.max[2]) / 2};
  const float width = begin.max[0] - begin.min[0];
  const float velocity[3] = {width, 0, 0};
  ASSERT_EQ(sightcell_db_prefetch(host.db(), eye, velocity, 2.0f), SIGHTCELL_OK);
  EXPECT_GE(host.requests, 2u);
  EXPECT_LT(host.requests, 10u) << "not the whole group";
  std::uint64_t next = section_offset(host.bytes(), 3);
  const auto sizes = chunk_sizes(contents);
  for (std::size_t cell = 0; cell < 64; next += sizes[cell], ++cell) {
    const auto is_this = [&](const page_request& r) { return r.offset == next; };
    if (std::none_of(host.waiting.begin(), host.waiting.end(), is_this)) continue;
    // Half of the distance traveled, half a step of time and the margin.
    const auto& b = contents.cells[cell];
    const float reach = 1.0625f * width + contents.facts.margin;
    EXPECT_LE(b.min[0], eye[0] + 2 * width + reach) << cell;
    EXPECT_LE(b.min[2], eye[2] + reach) << cell;
    EXPECT_GE(b.max[2], eye[2] - reach) << cell;
  }
  const std::size_t asked = host.requests;
  host.deliver_all();
  test_view view(host.db());
  EXPECT_EQ(view.move(eye[0], eye[1], eye[2]).flags & shown, 0u);
  EXPECT_EQ(view.move(eye[0] + width, eye[1], eye[2]).flags & shown, 0u);
  EXPECT_EQ(host.requests, asked);
}

TEST(paging, a_camera_that_prefetches_never_waits) {
  const sample_contents contents = long_street();
  const auto sizes = chunk_sizes(contents);
  const std::uint64_t room = 5 * static_cast<std::uint64_t>(*std::max_element(sizes.begin(), sizes.end()));
  for (const bool prefetches : {false, true}) {
    paged_host host(contents.encode());
    ASSERT_EQ(host.open(room), SIGHTCELL_OK);
    test_view view(host.db());
    int waits = 0;
    for (float x = 1.0f; x < 1270.0f; x += 0.5f) {  // 30 m/s in frames of 60 Hz
      const float eye[3] = {x, 1, 2};
      const float velocity[3] = {30, 0, 0};
      if (prefetches) {
        ASSERT_EQ(sightcell_db_prefetch(host.db(), eye, velocity, 2.0f), SIGHTCELL_OK);
      }
      if (x == 1.0f) host.deliver_all();
      waits += (view.move(x, 1, 2).flags & SIGHTCELL_FRAME_PENDING) != 0 ? 1 : 0;
      // Requests are delivered a second later.
      if (static_cast<int>(x * 2) % 60 == 0) host.deliver_all();
    }
    if (prefetches) {
      EXPECT_EQ(waits, 0);
      EXPECT_EQ(host.requests, 20u) << "each chunk once";
    } else {
      EXPECT_GT(waits, 100);
    }
  }
}

TEST(paging, prefetch_stays_within_the_room) {
  const sample_contents contents = long_street();
  paged_host host(contents.encode());
  const std::uint64_t room = 3 * largest(contents);
  ASSERT_EQ(host.open(room), SIGHTCELL_OK);
  const float eye[3] = {600, 1, 2};
  const float velocity[3] = {500, 0, 0};
  ASSERT_EQ(sightcell_db_prefetch(host.db(), eye, velocity, 10.0f), SIGHTCELL_OK);
  std::uint64_t asked = 0;
  for (const page_request& r : host.waiting) asked += r.size;
  EXPECT_LE(asked, room);
  EXPECT_GE(host.waiting.size(), 3u);
  host.deliver_all();
  ASSERT_EQ(sightcell_db_prefetch(host.db(), eye, velocity, 10.0f), SIGHTCELL_OK);
  EXPECT_TRUE(host.waiting.empty()) << "none evicts another";
}

TEST(paging, wrong_arguments) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  const loaded_file file(contents);
  auto* in_memory = const_cast<sightcell_db*>(file.db());
  const float good[3] = {1, 1, 1};
  const float bad[3] = {1, std::nanf(""), 1};
  const float far[3] = {1, std::numeric_limits<float>::infinity(), 1};
  EXPECT_EQ(sightcell_db_prefetch(nullptr, good, good, 1), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(host.db(), nullptr, good, 1), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(host.db(), good, nullptr, 1), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(host.db(), bad, good, 1), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(host.db(), good, far, 1), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(host.db(), good, good, -1), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(host.db(), good, good, std::nanf("")), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_prefetch(in_memory, good, good, 1), SIGHTCELL_OK);
  EXPECT_EQ(sightcell_db_deliver(nullptr, 1, good, 4), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_deliver(in_memory, 1, good, 4), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_check(host.db()), SIGHTCELL_ERR_IO);
}

TEST(paging, an_opening_that_does_not_wait) {
  const sample_contents contents = eight_chunks();
  paged_host host(contents.encode());
  ASSERT_EQ(host.begin(1 << 20), SIGHTCELL_PENDING);
  sightcell_view* early = nullptr;
  for (std::size_t request = 1; request <= 2; ++request) {
    EXPECT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_PENDING);
    EXPECT_EQ(sightcell_view_create(host.db(), &early), SIGHTCELL_PENDING);
    ASSERT_EQ(host.requests, request);
    const page_request r = host.waiting.back();
    EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket + 1, host.bytes().data(), r.size), SIGHTCELL_ERR_STALE);
    EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, host.bytes().data(), r.size - 1), SIGHTCELL_ERR_TRUNCATED);
    EXPECT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_PENDING) << "as before";
    std::thread([&] { EXPECT_EQ(host.deliver(r), SIGHTCELL_OK); }).join();
    EXPECT_EQ(host.deliver(r), SIGHTCELL_ERR_STALE) << "once";
  }
  ASSERT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_OK);
  EXPECT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_OK) << "stays open";
  host.waiting.clear();
  host.at_once = true;
  const loaded_file file(contents);
  test_view paged(host.db());
  test_view whole(file.db());
  for (std::uint32_t cell = 0; cell < 512; cell += 37) {
    static_cast<void>(go_to(paged, contents, cell));
    static_cast<void>(go_to(whole, contents, cell));
    ASSERT_EQ(paged.polygons(), whole.polygons());
  }
  EXPECT_EQ(sightcell_db_opened(const_cast<sightcell_db*>(file.db())), SIGHTCELL_OK);
}

TEST(paging, an_opening_whose_bytes_cannot_be_read_fails) {
  for (int good = 0; good < 2; ++good) {
    paged_host host(eight_chunks().encode());
    ASSERT_EQ(host.begin(1 << 20), SIGHTCELL_PENDING);
    for (int i = 0; i < good; ++i) {
      ASSERT_EQ(host.deliver(host.waiting.back()), SIGHTCELL_OK);
      ASSERT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_PENDING);
    }
    const page_request r = host.waiting.back();
    ASSERT_EQ(sightcell_db_deliver(host.db(), r.ticket, nullptr, 0), SIGHTCELL_OK);
    EXPECT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_ERR_IO);
    EXPECT_EQ(host.deliver(r), SIGHTCELL_ERR_STALE);
    EXPECT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_ERR_IO);
  }
  paged_host host(eight_chunks().encode());
  ASSERT_EQ(host.begin(10), SIGHTCELL_PENDING);
  ASSERT_EQ(host.deliver(host.waiting.back()), SIGHTCELL_OK);
  ASSERT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_PENDING);
  ASSERT_EQ(host.deliver(host.waiting.back()), SIGHTCELL_OK);
  EXPECT_EQ(sightcell_db_opened(host.db()), SIGHTCELL_ERR_CAPACITY);
}

// The answers of the source while the file is opened.
struct opening_host {
  std::vector<std::byte> bytes;
  sightcell_db* db = nullptr;
  int wrong_from = 1000;  // the first request with a wrong answer
  int requests = 0;
  sightcell_status (*wrong_answer)(opening_host&, const page_request&) = nullptr;

  sightcell_status open(std::uint64_t resident = 1 << 20, const sightcell_allocator* mem = nullptr) {
    requests = 0;
    const sightcell_source source{this, bytes.size(),
                                  [](void* user, std::uint64_t offset, std::uint32_t size, std::uint32_t ticket) {
                                    auto& self = *static_cast<opening_host*>(user);
                                    const page_request r{offset, size, ticket};
                                    if (++self.requests >= self.wrong_from) return self.wrong_answer(self, r);
                                    return sightcell_db_deliver(self.db, ticket, self.bytes.data() + offset, size);
                                  }};
    const sightcell_status s = sightcell_db_open_source(&source, mem, resident, &db);
    EXPECT_EQ(db == nullptr, s != SIGHTCELL_OK);
    sightcell_db_close(db);
    db = nullptr;
    return s;
  }
};

TEST(paging, open_fails_with_a_reason) {
  opening_host host;
  host.bytes = eight_chunks().encode();
  EXPECT_EQ(host.open(), SIGHTCELL_OK);
  EXPECT_EQ(host.open(100), SIGHTCELL_ERR_CAPACITY) << "no room for a chunk";
  for (const int from : {1, 2}) {
    host.wrong_from = from;
    host.wrong_answer = [](opening_host&, const page_request&) { return SIGHTCELL_ERR_IO; };
    EXPECT_EQ(host.open(), SIGHTCELL_ERR_IO);
    host.wrong_answer = [](opening_host&, const page_request&) { return SIGHTCELL_OK; };
    EXPECT_EQ(host.open(), SIGHTCELL_ERR_IO) << "nothing was delivered";
    host.wrong_answer = [](opening_host& self, const page_request& r) {
      EXPECT_EQ(sightcell_db_deliver(self.db, r.ticket, self.bytes.data(), r.size - 1), SIGHTCELL_ERR_TRUNCATED);
      EXPECT_EQ(sightcell_db_deliver(self.db, r.ticket + 1, self.bytes.data(), r.size), SIGHTCELL_ERR_STALE);
      EXPECT_EQ(sightcell_db_deliver(self.db, r.ticket, nullptr, 0), SIGHTCELL_OK);
      return SIGHTCELL_OK;
    };
    EXPECT_EQ(host.open(), SIGHTCELL_ERR_IO);
    host.wrong_answer = [](opening_host& self, const page_request& r) {
      std::vector<std::byte> other(self.bytes.begin(), self.bytes.begin() + static_cast<std::ptrdiff_t>(r.size));
      other[r.size / 2] ^= std::byte{1};
      return sightcell_db_deliver(self.db, r.ticket, other.data(), r.size);
    };
    EXPECT_EQ(host.open(), SIGHTCELL_ERR_CHECKSUM);
  }
  host.wrong_from = 1000;
  EXPECT_EQ(sightcell_db_open_source(nullptr, nullptr, 1, &host.db), SIGHTCELL_ERR_ARGUMENT);
  const sightcell_source silent{nullptr, 10, nullptr};
  EXPECT_EQ(sightcell_db_open_source(&silent, nullptr, 1, &host.db), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_open_source(&silent, nullptr, 1, nullptr), SIGHTCELL_ERR_ARGUMENT);
  host.bytes = golden_file("v0_small");
  EXPECT_EQ(host.open(), SIGHTCELL_ERR_VERSION) << "has no front of its own";
}

TEST(paging, files_cut_at_any_length) {
  const auto whole = tiny_contents().encode();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    opening_host host;
    host.bytes.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(host.open(), SIGHTCELL_OK) << size;
  }
}

TEST(paging, files_with_any_byte_changed) {
  const auto whole = tiny_contents().encode();
  const std::size_t rows = section_offset(whole, 3);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    opening_host host;
    host.bytes = whole;
    host.bytes[at] ^= std::byte{16};
    EXPECT_EQ(host.open() == SIGHTCELL_OK, at >= rows) << at << ": rows are checked when they are used";
  }
}

TEST(paging, out_of_memory_at_any_allocation) {
  struct rationed {
    int left = 0;
    std::size_t held = 0;
  };
  for (int allowed = 0; allowed < 4; ++allowed) {
    rationed ration{allowed};
    const sightcell_allocator mem{[](void* user, std::size_t size, std::size_t) -> void* {
                                    auto& r = *static_cast<rationed*>(user);
                                    if (r.left-- == 0) return nullptr;
                                    r.held += size;
                                    return std::malloc(size);
                                  },
                                  [](void* user, void* block, std::size_t size) {
                                    static_cast<rationed*>(user)->held -= size;
                                    std::free(block);
                                  },
                                  &ration};
    opening_host host;
    host.bytes = eight_chunks().encode();
    EXPECT_EQ(host.open(1 << 20, &mem), allowed < 3 ? SIGHTCELL_ERR_MEMORY : SIGHTCELL_OK);
    EXPECT_EQ(ration.held, 0u);
  }
}

}  // namespace
