// Functions for tools and tests: statistics, debug lines, the text of reported misses.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "held_memory.h"
#include "loaded_file.h"
#include "paged_host.h"
#include "sightcell/format/layout.h"
#include "unit/format/viewpoint_samples.h"

namespace {

using namespace sightcell::test;

sightcell_view_stats stats_of(const test_view& view) {
  sightcell_view_stats stats{};
  stats.struct_size = sizeof stats;
  EXPECT_EQ(sightcell_view_statistics(view.get(), &stats), SIGHTCELL_OK);
  return stats;
}

sightcell_db_stats stats_of(const sightcell_db* db) {
  sightcell_db_stats stats{};
  stats.struct_size = sizeof stats;
  EXPECT_EQ(sightcell_db_statistics(db, &stats), SIGHTCELL_OK);
  return stats;
}

TEST(tools, statistics_of_a_view) {
  const sample_contents contents = tiny_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  EXPECT_EQ(stats_of(view).moves, 0u);
  static_cast<void>(view.move(1, 1, 1));
  static_cast<void>(view.move(2, 1, 1));
  static_cast<void>(view.move(5, 1, 1));
  static_cast<void>(view.move(50, 1, 1));
  const sightcell_view_stats stats = stats_of(view);
  EXPECT_EQ(stats.struct_size, sizeof stats);
  EXPECT_EQ(stats.moves, 4u);
  EXPECT_EQ(stats.rows_decoded, 2u);
  EXPECT_EQ(stats.changes, 3u);
  EXPECT_EQ(stats.moves_outside, 1u);
  EXPECT_EQ(stats.moves_draw_all, 1u);
  EXPECT_EQ(stats.moves_pending, 0u);
  EXPECT_EQ(stats.polygons, 4u + 4u + 1u + 6u);
  sightcell_view_stats small{};
  small.struct_size = sizeof small - 1;
  EXPECT_EQ(sightcell_view_statistics(view.get(), &small), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_statistics(nullptr, &small), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_statistics(view.get(), nullptr), SIGHTCELL_ERR_ARGUMENT);
}

TEST(tools, statistics_distinguish_flags) {
  auto bytes = small_contents().encode();
  bytes.back() ^= std::byte{1};  // cells 64 to 66 are damaged
  const loaded_file file(std::move(bytes));
  test_view view(file.db());
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, 100.0f), SIGHTCELL_OK);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(view.move(0.5f, -5, 0.5f).flags & ~1u, SIGHTCELL_FRAME_OUTSIDE);
  sightcell_view_stats stats = stats_of(view);
  EXPECT_EQ(stats.moves_outside, 3u);
  EXPECT_EQ(stats.moves_draw_all, 0u);
  EXPECT_EQ(stats.rows_decoded, 1u);
  EXPECT_EQ(stats.changes, 1u);
  const std::uint64_t polygons = stats.polygons;
  EXPECT_EQ(view.move(0.5f, 1.5f, 0.5f).flags & SIGHTCELL_FRAME_DAMAGED, SIGHTCELL_FRAME_DAMAGED);
  static_cast<void>(view.move(std::nanf(""), 1, 1, SIGHTCELL_ERR_ARGUMENT));
  stats = stats_of(view);
  EXPECT_EQ(stats.moves, 5u);
  EXPECT_EQ(stats.moves_outside, 3u);
  EXPECT_EQ(stats.moves_draw_all, 2u);
  EXPECT_EQ(stats.rows_decoded, 1u) << "a damaged set is not counted";
  EXPECT_EQ(stats.polygons, polygons + 2 * 300);
}

TEST(tools, statistics_of_a_db) {
  const sample_contents contents = random_contents(3, {.polygons = 500, .draws = 5, .cells = 200});
  const loaded_file file(contents);
  const sightcell_db_stats in_memory = stats_of(file.db());
  EXPECT_EQ(in_memory.chunk_count, 4u);
  EXPECT_GT(in_memory.memory_bytes, 1000u);
  EXPECT_EQ(in_memory.requests + in_memory.resident_bytes + in_memory.evictions, 0u);
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view view(host.db());
  const auto& b = contents.cells[0];
  static_cast<void>(view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f));
  EXPECT_EQ(stats_of(host.db()).requests, 1u);
  EXPECT_EQ(stats_of(host.db()).resident_bytes, 0u);
  EXPECT_EQ(stats_of(view).moves_pending, 1u);
  const page_request r = host.waiting[0];
  host.deliver_all();
  EXPECT_EQ(host.deliver(r), SIGHTCELL_ERR_STALE);
  const sightcell_db_stats paged = stats_of(host.db());
  EXPECT_EQ(paged.resident_bytes, r.size);
  EXPECT_EQ(paged.delivered_bytes, r.size);
  EXPECT_EQ(paged.refused_deliveries, 1u);
  sightcell_db_stats small{};
  EXPECT_EQ(sightcell_db_statistics(file.db(), &small), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_statistics(nullptr, &small), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_statistics(file.db(), nullptr), SIGHTCELL_ERR_ARGUMENT);
}

TEST(tools, statistics_count_the_memory) {
  const auto bytes = small_contents().encode();
  const std::string name = testing::TempDir() + "sightcell_tools.pvs";
  ASSERT_EQ(sightcell::format::write_file(name.c_str(), bytes), sightcell::format::status::ok);
  held_memory memory;
  sightcell_db* db = nullptr;
  ASSERT_EQ(sightcell_db_open_file(name.c_str(), &memory.interface, &db), SIGHTCELL_OK);
  std::remove(name.c_str());
  EXPECT_EQ(stats_of(db).memory_bytes, memory.bytes);
  EXPECT_GT(memory.bytes, bytes.size());
  sightcell_db_close(db);
  {
    const loaded_file file(bytes, &memory.interface);
    EXPECT_EQ(stats_of(file.db()).memory_bytes, memory.bytes);
  }
  paged_host host(bytes);
  ASSERT_EQ(host.open(1 << 20, &memory.interface), SIGHTCELL_OK);
  EXPECT_EQ(stats_of(host.db()).memory_bytes, memory.bytes);
}

TEST(tools, statistics_with_little_room) {
  const sample_contents contents = random_contents(3, {.polygons = 500, .draws = 5, .cells = 200});
  paged_host host(contents.encode());
  const std::size_t directory = section_offset(host.bytes(), 4);
  std::array<std::uint32_t, 4> sizes;
  for (std::size_t chunk = 0; chunk < 4; ++chunk) sizes[chunk] = get_u32(host.bytes(), directory + 16 * chunk + 8);
  ASSERT_EQ(host.open(*std::max_element(sizes.begin(), sizes.end())), SIGHTCELL_OK);  // for one chunk
  test_view view(host.db());
  const auto ask = [&](std::uint32_t chunk) {
    const auto& b = contents.cells[64 * chunk];
    static_cast<void>(view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f));
    const page_request r = host.waiting.back();
    host.waiting.clear();
    return r;
  };
  for (const std::uint32_t chunk : {0u, 1u, 0u}) EXPECT_EQ(host.deliver(ask(chunk)), SIGHTCELL_OK);
  sightcell_db_stats stats = stats_of(host.db());
  EXPECT_EQ(stats.requests, 3u);
  EXPECT_EQ(stats.evictions, 2u);
  EXPECT_EQ(stats.resident_bytes, sizes[0]);
  EXPECT_EQ(stats.delivered_bytes, std::uint64_t{2} * sizes[0] + sizes[1]);
  EXPECT_EQ(stats.refused_deliveries, 0u);

  page_request r = ask(1);
  EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, nullptr, 0), SIGHTCELL_OK);
  EXPECT_EQ(stats_of(host.db()).refused_deliveries, 0u) << "a read error of the host is not counted";
  r = ask(1);
  EXPECT_EQ(sightcell_db_deliver(host.db(), r.ticket, host.bytes().data() + r.offset, r.size - 1),
            SIGHTCELL_ERR_TRUNCATED);
  r = ask(1);
  host.bytes()[r.offset + r.size / 2] ^= std::byte{64};
  EXPECT_EQ(host.deliver(r), SIGHTCELL_ERR_CHECKSUM);
  stats = stats_of(host.db());
  EXPECT_EQ(stats.refused_deliveries, 2u);
  EXPECT_EQ(stats.resident_bytes, 0u) << "the damaged one takes no room, though another one was evicted for it";
  EXPECT_EQ(stats.evictions, 3u);
  EXPECT_EQ(stats.delivered_bytes, std::uint64_t{2} * sizes[0] + sizes[1]);
}

std::vector<sightcell_debug_line> lines_of(const test_view& view, std::uint32_t kinds) {
  std::size_t count = 0;
  static_cast<void>(sightcell_view_debug_lines(view.get(), kinds, nullptr, 0, &count));
  std::vector<sightcell_debug_line> lines(count);
  EXPECT_EQ(sightcell_view_debug_lines(view.get(), kinds, lines.data(), lines.size(), &count), SIGHTCELL_OK);
  return lines;
}

// The twelve edges of a box: each axis four times, every corner an end of three.
void expect_box(std::span<const sightcell_debug_line> lines, const std::array<float, 3>& min,
                const std::array<float, 3>& max) {
  ASSERT_EQ(lines.size(), 12u);
  std::multiset<std::array<float, 3>> ends;
  std::array<int, 3> along{};
  for (const sightcell_debug_line& line : lines) {
    int differ = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (line.from[axis] == line.to[axis]) continue;
      ++differ;
      ++along[axis];
      EXPECT_FLOAT_EQ(line.from[axis], min[axis]);
      EXPECT_FLOAT_EQ(line.to[axis], max[axis]);
    }
    EXPECT_EQ(differ, 1);
    for (const float* end : {line.from, line.to}) ends.insert({end[0], end[1], end[2]});
  }
  EXPECT_EQ(along, (std::array<int, 3>{4, 4, 4}));
  for (const auto& corner : ends) EXPECT_EQ(ends.count(corner), 3u);
}

TEST(tools, debug_lines) {
  const sample_contents contents = tiny_contents();  // (0 0 0) (4 2 4) and (4 0 0) (8 2 4)
  const loaded_file file(contents);
  test_view view(file.db());
  EXPECT_TRUE(lines_of(view, 15).empty()) << "before the first move";
  static_cast<void>(view.move(1, 1, 1));
  const auto own = lines_of(view, SIGHTCELL_DEBUG_CELL);
  expect_box(own, {0, 0, 0}, {4, 2, 4});
  const auto kept = lines_of(view, SIGHTCELL_DEBUG_KEPT);
  expect_box(kept, {-0.25f, -0.25f, -0.25f}, {4.25f, 2.25f, 4.25f});
  for (const auto& [lines, kind] : {std::pair(own, SIGHTCELL_DEBUG_CELL), std::pair(kept, SIGHTCELL_DEBUG_KEPT)}) {
    EXPECT_EQ(lines[0].kind, static_cast<std::uint32_t>(kind));
    EXPECT_EQ(lines[0].number, 0u);
  }
  const auto neighbors = lines_of(view, SIGHTCELL_DEBUG_NEIGHBORS);
  expect_box(neighbors, {4, 0, 0}, {8, 2, 4});
  EXPECT_EQ(neighbors[0].kind, SIGHTCELL_DEBUG_NEIGHBORS);
  EXPECT_EQ(neighbors[0].number, 1u);
  EXPECT_EQ(lines_of(view, 15).size(), 36u);
  const double origin[3] = {10, 0, 0};
  ASSERT_EQ(sightcell_view_origin(view.get(), origin), SIGHTCELL_OK);
  static_cast<void>(view.move(-9, 1, 1));
  expect_box(lines_of(view, SIGHTCELL_DEBUG_CELL), {-10, 0, 0}, {-6, 2, 4});
  static_cast<void>(view.move(90, 1, 1));
  EXPECT_TRUE(lines_of(view, 15).empty()) << "outside";
  std::size_t count = 0;
  EXPECT_EQ(sightcell_view_debug_lines(nullptr, 15, nullptr, 0, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_debug_lines(view.get(), 15, nullptr, 0, nullptr), SIGHTCELL_ERR_ARGUMENT);
}

TEST(tools, debug_lines_of_volumes) {
  sample_contents contents = random_contents(5, {.polygons = 50, .draws = 2, .cells = 20});
  add_volumes(contents, 30, 5);
  contents.sets[0] = {3, 50 + 4, 50 + 29};
  const loaded_file file(contents);
  test_view view(file.db());
  const auto& b = contents.cells[0];
  static_cast<void>(view.move(b.min[0] + 0.5f, b.min[1] + 0.5f, b.min[2] + 0.5f));
  const auto lines = lines_of(view, SIGHTCELL_DEBUG_VOLUMES);
  ASSERT_EQ(lines.size(), 24u);
  EXPECT_EQ(lines_of(view, SIGHTCELL_DEBUG_CELL).size(), 12u) << "no other kind";
  EXPECT_EQ(lines[0].number, 4u);
  EXPECT_EQ(lines[12].number, 29u);
  static_cast<void>(view.move(-1e5f, 0, 0));
  EXPECT_EQ(lines_of(view, SIGHTCELL_DEBUG_VOLUMES).size(), 360u) << "everything is visible";
}

// tiny_contents(): the lower x half of the grown box of cell 0 is outside, and half of the upper one.
sample_contents contents_with_regions() {
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 4);
  contents.viewpoints[0].region = packed_nodes("20210");
  contents.viewpoints[1].region = {};
  contents.viewpoints[1].outside_share = 0.0;
  return contents;
}

TEST(tools, debug_lines_outside_the_region) {
  const loaded_file file(contents_with_regions());
  test_view view(file.db());
  EXPECT_TRUE(lines_of(view, SIGHTCELL_DEBUG_OUTSIDE_REGION).empty()) << "before the first move";
  static_cast<void>(view.move(1, 1, 1));
  const auto lines = lines_of(view, SIGHTCELL_DEBUG_OUTSIDE_REGION);
  ASSERT_EQ(lines.size(), 24u);
  expect_box(std::span(lines).first(12), {-0.25f, -0.25f, -0.25f}, {2, 2.25f, 4.25f});
  expect_box(std::span(lines).last(12), {2, -0.25f, 2}, {4.25f, 2.25f, 4.25f});
  for (const sightcell_debug_line& line : lines) {
    EXPECT_EQ(line.kind, SIGHTCELL_DEBUG_OUTSIDE_REGION);
    EXPECT_EQ(line.number, 0u);
  }
  EXPECT_EQ(lines_of(view, 15).size(), 36u) << "no other kind";
  EXPECT_EQ(lines_of(view, 31).size(), 60u);
  std::size_t count = 0;
  std::vector<sightcell_debug_line> few(23);
  EXPECT_EQ(sightcell_view_debug_lines(view.get(), SIGHTCELL_DEBUG_OUTSIDE_REGION, few.data(), few.size(), &count),
            SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(count, 24u);
  EXPECT_EQ(few[0].kind, 0u) << "nothing is written";
  static_cast<void>(view.move(7, 1, 1));
  EXPECT_TRUE(lines_of(view, SIGHTCELL_DEBUG_OUTSIDE_REGION).empty()) << "the whole box";
  static_cast<void>(view.move(90, 1, 1));
  EXPECT_TRUE(lines_of(view, SIGHTCELL_DEBUG_OUTSIDE_REGION).empty()) << "outside all cells";
  const loaded_file without(tiny_contents());
  test_view other(without.db());
  static_cast<void>(other.move(1, 1, 1));
  EXPECT_TRUE(lines_of(other, SIGHTCELL_DEBUG_OUTSIDE_REGION).empty());
}

TEST(tools, debug_lines_of_a_damaged_region) {
  auto bytes = contents_with_regions().encode();
  const std::size_t place = section_place(bytes, sightcell::format::layout::section_viewpoints);
  bytes[get_u64(bytes, place + 8) + get_u64(bytes, place + 16) - 1] = std::byte{3};  // the last node is left alone
  reseal(bytes);
  const loaded_file file(std::move(bytes));
  test_view view(file.db());
  static_cast<void>(view.move(1, 1, 1));
  std::size_t count = 7;
  EXPECT_EQ(sightcell_view_debug_lines(view.get(), 31, nullptr, 0, &count), SIGHTCELL_ERR_CORRUPT);
  EXPECT_EQ(count, 7u);
  EXPECT_EQ(lines_of(view, 15).size(), 36u) << "other kinds do not need it";
  static_cast<void>(view.move(7, 1, 1));
  EXPECT_EQ(lines_of(view, 31).size(), 36u) << "nor do other cells";
}

// A small cell in 80 large ones.
TEST(tools, debug_lines_of_many_large_neighbors) {
  for (const std::uint32_t own : {0u, 40u, 80u}) {
    sample_contents contents = random_contents(7, {.polygons = 20, .draws = 2, .cells = 81});
    for (std::uint32_t cell = 0; cell < 81; ++cell) {
      const auto more = static_cast<float>(cell) / 8.0f;
      contents.cells[cell] = {{-more, 0, 0}, {8 + more, 8, 8}};
    }
    contents.cells[own] = {{3, 3, 3}, {4, 4, 4}};
    const loaded_file file(contents);
    test_view view(file.db());
    ASSERT_EQ(view.move(3.5f, 3.5f, 3.5f).cell, own);
    const auto lines = lines_of(view, SIGHTCELL_DEBUG_NEIGHBORS);
    EXPECT_EQ(lines.size(), 64u * 12) << own;
    for (const sightcell_debug_line& line : lines) ASSERT_NE(line.number, own);
  }
}

// A large cell with 80 small ones in it.
TEST(tools, debug_lines_of_many_neighbors) {
  for (const bool large_is_last : {false, true}) {
    sample_contents contents = random_contents(6, {.polygons = 20, .draws = 2, .cells = 81});
    if (!large_is_last) std::rotate(contents.cells.begin(), contents.cells.end() - 1, contents.cells.end());
    const std::uint32_t large = large_is_last ? 80 : 0;
    contents.cells[large] = {{0, 0, 0}, {8, 8, 8}};
    const loaded_file file(contents);
    test_view view(file.db());
    ASSERT_EQ(view.move(4, 6, 4).cell, large);
    const auto lines = lines_of(view, SIGHTCELL_DEBUG_NEIGHBORS);
    EXPECT_EQ(lines.size(), 64u * 12);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      ASSERT_NE(lines[i].number, large);
      ASSERT_EQ(lines[i].kind, SIGHTCELL_DEBUG_NEIGHBORS);
      ASSERT_TRUE(i < 12 || lines[i].number > lines[i - 12].number) << "in the order of their numbers";
    }
  }
}

std::string text_of(const sightcell_db* db, const std::vector<sightcell_miss>& misses) {
  std::size_t count = 0;
  EXPECT_EQ(sightcell_db_misses_text(db, misses.data(), misses.size(), nullptr, 0, &count), SIGHTCELL_ERR_CAPACITY);
  std::string text(count, '?');
  EXPECT_EQ(sightcell_db_misses_text(db, misses.data(), misses.size(), text.data(), text.size(), &count), SIGHTCELL_OK);
  EXPECT_EQ(count, text.size());
  return text;
}

TEST(tools, misses_text) {
  const sample_contents contents = tiny_contents();
  const loaded_file file(contents);
  const std::string head = "{\"scene_fingerprint\": \"a0a1a2a3a4a5a6a7a8a9aaabacadaeaf\", \"misses\": [";
  EXPECT_EQ(text_of(file.db(), {}), head + "\n]}\n");
  EXPECT_EQ(text_of(file.db(), {{{1.5, -0.25, 100000.015625}, 5, 0}, {{-1e-12, 0.0, -999999999.0}, 0, 0}}),
            head +
                "\n  {\"eye\": [1.500000000, -0.250000000, 100000.015625000], \"polygon\": 5},"
                "\n  {\"eye\": [0.000000000, 0.000000000, -999999999.000000000], \"polygon\": 0}\n]}\n");
  std::size_t count = 7;
  char room[10];
  std::memset(room, 'x', sizeof room);
  EXPECT_EQ(sightcell_db_misses_text(file.db(), nullptr, 0, room, sizeof room, &count), SIGHTCELL_ERR_CAPACITY);
  EXPECT_EQ(room[0], 'x') << "nothing is written";
  EXPECT_EQ(text_of(file.db(), {{{1e9, -6e-10, 4e-10}, 1, 0}}),
            head + "\n  {\"eye\": [1000000000.000000000, -0.000000001, 0.000000000], \"polygon\": 1}\n]}\n");
  for (const sightcell_miss& wrong : {sightcell_miss{{0, 0, 0}, 6, 0}, sightcell_miss{{0, 1e9 + 1, 0}, 0, 0},
                                      sightcell_miss{{0, 0, std::nan("")}, 0, 0}}) {
    EXPECT_EQ(sightcell_db_misses_text(file.db(), &wrong, 1, room, sizeof room, &count), SIGHTCELL_ERR_ARGUMENT);
  }
  EXPECT_EQ(sightcell_db_misses_text(nullptr, nullptr, 0, room, sizeof room, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_misses_text(file.db(), nullptr, 1, room, sizeof room, &count), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_misses_text(file.db(), nullptr, 0, room, sizeof room, nullptr), SIGHTCELL_ERR_ARGUMENT);
}

}  // namespace
