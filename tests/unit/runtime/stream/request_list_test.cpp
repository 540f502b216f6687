// The order in which a view asks for files.
#include <gtest/gtest.h>

#include <algorithm>

#include "small_stream.h"

namespace {

using namespace sightcell::test;
using numbers = std::vector<std::uint32_t>;

// One cell around the origin with pages in all directions, 20 m away.
small_stream one_cell() {
  small_stream s;
  s.box = {-51, -51, -51, 51, 51, 51};  // steps of 0.4 m
  s.add_draw();
  const auto at = [](int meters) { return static_cast<std::uint8_t>((meters + 51) * 5 / 2); };
  const auto page = [&](std::uint32_t size, int x, int y, int z) {
    s.pages.push_back({size, {at(x - 1), at(y - 1), at(z - 1), at(x + 1), at(y + 1), at(z + 1)}});
  };
  page(100, 20, 0, 0);   // heading 0 degrees, at the border of sectors 7 and 0
  page(100, 0, 0, 20);   // 90 degrees
  page(100, -20, 0, 0);  // 180 degrees
  page(100, 0, 0, -20);  // 270 degrees
  page(100, 0, 20, 0);   // above
  s.chunks = {{{0,
                {-1, -1, -1, 1, 1, 1},
                {{0, 8, 0x81}, {1, 8, 0x06}, {2, 8, 0x18}, {3, 8, 0x60}, {4, 8, 0xFF}},
                {{0, 1}},
                {}}}};
  return s;
}

void look(open_stream& scene, float x, float y, float z) {
  scene.pose.forward[0] = x, scene.pose.forward[1] = y, scene.pose.forward[2] = z;
  scene.pose.up[0] = y != 0.0f ? 1.0f : 0.0f;
  scene.pose.up[1] = y != 0.0f ? 0.0f : 1.0f;
  scene.pose.half_width = 0.7f, scene.pose.half_height = 0.5f;
  static_cast<void>(scene.move(0, 0, 0));
}

TEST(stream_requests, weight_per_byte_decides) {
  small_stream content = one_cell();
  content.pages[1].bytes = 400;             // a quarter
  content.chunks[0][0].pages[3].share = 0;  // twice
  open_stream scene(content);
  scene.load(0);
  static_cast<void>(scene.move(0, 0, 0));
  EXPECT_EQ(scene.requested_files(),
            (numbers{content.page(3), content.page(0), content.page(2), content.page(4), content.page(1)}));
  const auto requests = scene.requests();
  EXPECT_EQ(requests[0].reason, std::uint32_t{SIGHTCELL_STREAM_FOR_CELL});
  EXPECT_EQ(requests[0].weight, 4.0f);
  EXPECT_EQ(requests[1].weight, 2.0f);
}

TEST(stream_requests, what_is_ahead_comes_first) {
  const small_stream content = one_cell();
  open_stream scene(content);
  scene.load(0);
  const float directions[5][3] = {{1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  for (std::uint32_t k = 0; k < 5; ++k) {
    look(scene, directions[k][0], directions[k][1], directions[k][2]);
    const auto requests = scene.requests();
    ASSERT_EQ(requests.size(), 5u);
    EXPECT_EQ(requests[0].file, content.page(k));
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(requests[i].ahead > 8, i == 0) << k << ' ' << i;
  }
  look(scene, 0, 0, 0);
  for (const auto& request : scene.requests()) EXPECT_EQ(request.ahead, 64u) << "no direction: all of them";
}

TEST(stream_requests, headings_exclude_pages_whose_box_is_ahead) {
  small_stream content = one_cell();
  content.pages[0].box = {0, 0, 0, 255, 255, 255};
  content.chunks[0][0].pages[0].headings = 0x18;  // behind
  open_stream scene(content);
  scene.load(0);
  look(scene, 1, 0, 0);
  for (const auto& request : scene.requests()) EXPECT_EQ(request.ahead, 0u) << request.file;
  look(scene, -1, 0, 0);
  for (const auto& request : scene.requests())
    EXPECT_EQ(request.ahead > 0, request.file == content.page(0) || request.file == content.page(2));
}

TEST(stream_requests, what_is_in_the_view_counts_by_its_share) {
  small_stream content = one_cell();
  for (std::uint32_t k = 0; k < 5; ++k) content.pages[k].box = {0, 0, 0, 255, 255, 255};
  const std::uint8_t headings[5] = {0x02, 0x03, 0x0F, 0xFF, 0x20};
  for (std::uint32_t k = 0; k < 5; ++k) content.chunks[0][0].pages[k].headings = headings[k];
  open_stream scene(content);
  scene.load(0);
  look(scene, 0.70710678f, 0, 0.70710678f);
  scene.pose.half_width = 1;  // headings from 0 to 90 degrees: sectors 0 and 1
  const auto ahead = [&] {
    static_cast<void>(scene.move(0, 0, 0));
    std::vector<std::uint32_t> found(5);
    for (const auto& request : scene.requests()) found[request.file - content.page(0)] = request.ahead;
    return found;
  };
  EXPECT_EQ(ahead(), (numbers{64, 64, 32, 16, 0}));
  EXPECT_EQ(scene.requested_files(),
            (numbers{content.page(0), content.page(1), content.page(2), content.page(3), content.page(4)}));
  scene.pose.half_width = 0.41421356f;  // 22.5 degrees to each side
  EXPECT_EQ(ahead(), (numbers{32, 32, 16, 8, 0}));
  look(scene, 0.6f, 0, 0.8f);
  scene.pose.half_width = 1e-4f;
  EXPECT_EQ(ahead(), (numbers{8, 4, 2, 1, 0})) << "between the middles of two eighths";
  look(scene, 0.6f, 5, 0.8f);
  scene.pose.half_width = scene.pose.half_height = 0.5f;
  EXPECT_EQ(ahead(), (numbers{64, 64, 64, 64, 64})) << "the vertical is in the view";
}

TEST(stream_requests, a_page_with_three_quarters_ahead_counts_48_times) {
  small_stream content = one_cell();
  content.chunks[0][0].pages[0].share = 52;  // 44 eighths of an octave less than the others: 2^(-44 / 8) > 1 / 48
  open_stream scene(content);
  scene.load(0);
  look(scene, 1, 0, 0);
  EXPECT_EQ(scene.requested_files().front(), content.page(0));
  content.chunks[0][0].pages[0].share = 53;
  open_stream other(content);
  other.load(0);
  look(other, 1, 0, 0);
  EXPECT_EQ(other.requested_files().back(), content.page(0));
}

TEST(stream_requests, small_images_with_the_cell_and_larger_ones_after_it) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  scene.load(0);
  static_cast<void>(scene.move(5, 5, 5));
  auto requests = scene.requests();
  ASSERT_EQ(requests.size(), 2u);
  EXPECT_EQ(requests[0].file, content.image(0)) << "half of the weight in a tenth of the bytes";
  EXPECT_EQ(requests[1].file, content.page(0));
  scene.load(content.image(0));
  EXPECT_EQ(scene.requested_files(), (numbers{content.page(0), content.image(0, 1)}));
  EXPECT_EQ(scene.requests()[1].reason, std::uint32_t{SIGHTCELL_STREAM_FOR_DETAIL});
  scene.set(content.image(0, 1), SIGHTCELL_STREAM_REQUESTED);
  EXPECT_EQ(scene.requested_files(), numbers{content.page(0)}) << "one version of an image at a time";
  scene.load(content.image(0, 1));
  EXPECT_EQ(scene.requested_files(), (numbers{content.page(0), content.image(0, 2)}));
  scene.set(content.image(0, 0), SIGHTCELL_STREAM_ABSENT);
  EXPECT_EQ(scene.requested_files(), (numbers{content.page(0), content.image(0, 2)})) << "no smaller one again";
}

TEST(stream_requests, an_image_whose_small_version_failed_gets_the_next_one) {
  const small_stream content = four_rooms();
  open_stream scene(content);
  scene.load(0);
  scene.set(content.image(0), SIGHTCELL_STREAM_FAILED);
  static_cast<void>(scene.move(5, 5, 5));
  EXPECT_EQ(scene.requested_files(), (numbers{content.image(0, 1), content.page(0)}));
}

TEST(stream_requests, next_cells_in_the_order_in_which_they_are_reached) {
  small_stream content = four_rooms();
  open_stream scene(content);
  for (const std::uint32_t file : {0u, content.page(0), content.image(0), content.image(0, 1), content.image(0, 2)})
    scene.load(file);
  scene.pose.velocity[0] = 10;
  static_cast<void>(scene.move(5, 5, 5));
  EXPECT_EQ(scene.requested_files(0.0f), numbers{});
  EXPECT_EQ(scene.requested_files(0.3f), numbers{}) << "3 m do not reach the next room";
  EXPECT_EQ(scene.requested_files(0.8f), numbers{content.page(1)});
  EXPECT_EQ(scene.requested_files(4.0f), (numbers{content.page(1), 1})) << "then the chunk after it";
  scene.load(1);
  EXPECT_EQ(scene.requested_files(4.0f),
            (numbers{content.page(1), content.image(1), content.page(2), content.page(3)}));
  for (const auto& request : scene.requests(4.0f)) EXPECT_EQ(request.reason, std::uint32_t{SIGHTCELL_STREAM_FOR_NEXT});
  scene.pose.velocity[0] = -10;
  static_cast<void>(scene.move(5, 5, 5));
  EXPECT_EQ(scene.requested_files(0.5f), numbers{});
  scene.pose.velocity[0] = 0;
  static_cast<void>(scene.move(9.5f, 5, 5));
  EXPECT_EQ(scene.requested_files(1.0f), numbers{content.page(1)}) << "it may start to walk";
}

TEST(stream_requests, a_short_list_is_the_begin_of_a_long_one) {
  small_stream content = one_cell();
  for (std::uint32_t i = 0; i < 60; ++i) {
    content.pages.push_back({100 + i * 37 % 61, {0, 0, 0, 255, 255, 255}});
    content.chunks[0][0].pages.push_back({5 + i, static_cast<std::uint8_t>(i * 29 % 64), 0xFF});
  }
  content.images = {{10}, {20}};
  content.chunks[0][0].images = {{0, 3}, {1, 30}};
  content.images_everywhere = {1};
  open_stream scene(content);
  scene.load(0);
  look(scene, 1, 0, 0);
  const auto all = scene.requests(3.0f, 200);
  ASSERT_EQ(all.size(), 67u);
  for (std::size_t capacity = 0; capacity <= all.size(); ++capacity) {
    const auto some = scene.requests(3.0f, capacity);
    ASSERT_EQ(some.size(), capacity);
    for (std::size_t i = 0; i < capacity; ++i) ASSERT_EQ(some[i].file, all[i].file) << capacity;
  }
}

TEST(stream_requests, before_the_first_move_there_are_none) {
  const small_stream content = four_rooms();
  const open_stream scene(content);
  EXPECT_EQ(scene.requested_files(5.0f), numbers{});
}

}  // namespace
