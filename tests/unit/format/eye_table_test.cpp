#include "sightcell/format/eye_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random_source.h"
#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "viewpoint_samples.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

status open_eyes(const std::vector<std::byte>& bytes, eye_table& out) {
  reader file;
  EXPECT_EQ(reader::open(bytes, file), status::ok);
  return eye_table::open(file, out);
}

sample_contents tiny_contents_with_eyes() {
  sample_contents contents = tiny_contents();
  add_viewpoints(contents, 1);
  contents.viewpoints[0].eyes = {{0, 1, 2}, {4095, 7, 9}};
  contents.viewpoints[1].eyes = {{5, 6, 4000}};
  return contents;
}

bool is_inside(const box& cell, const std::array<float, 3>& p) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(cell.min[axis] <= p[axis] && p[axis] < cell.max[axis])) return false;
  }
  return true;
}

TEST(eye_table, what_is_written_is_read) {
  sample_contents contents = random_contents(5, {.polygons = 100, .cells = 140, .overlapping = true});
  add_viewpoints(contents, 2);
  add_eyes(contents, 3);
  eye_table eyes;
  const auto bytes = contents.encode();
  ASSERT_EQ(open_eyes(bytes, eyes), status::ok);
  std::size_t all = 0;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& given = contents.viewpoints[cell].eyes;
    ASSERT_EQ(eyes.count(cell), given.size()) << cell;
    all += given.size();
    for (std::uint32_t number = 0; number < given.size(); ++number) {
      eye_steps eye;
      ASSERT_EQ(eyes.eye(cell, number, eye), status::ok);
      EXPECT_EQ(eye, given[number]);
      const auto position = eye_position(contents.cells[cell], eye);
      EXPECT_TRUE(is_inside(contents.cells[cell], position));
      EXPECT_EQ(eye_at(contents.cells[cell], position), eye);
    }
    eye_steps eye;
    EXPECT_EQ(eyes.eye(cell, eyes.count(cell), eye), status::argument);
  }
  EXPECT_GT(all, 140u);
  EXPECT_EQ(eyes.count(140), 0u);
}

TEST(eye_table, positions_stay_inside_boxes_of_few_floats) {
  random_source random(4);
  for (const float begin : {-16777216.0f, -2.0f, -1.0f, 0.0f, 1.0f, 3000.0f, 16777214.0f}) {
    for (int steps = 1; steps < 5; ++steps) {
      float end = begin;
      for (int i = 0; i < steps; ++i) end = std::nextafter(end, 1e30f);
      const box cell{{begin, begin, begin}, {end, end, end}};
      for (int i = 0; i < 100; ++i) {
        const auto q = static_cast<std::uint16_t>(random.below(4096));
        EXPECT_TRUE(is_inside(cell, eye_position(cell, {q, 0, 4095}))) << begin << ' ' << steps << ' ' << q;
      }
    }
  }
  const box up_to_zero{{-1e-45f, -1, -1}, {0, 0, 1}};
  EXPECT_TRUE(is_inside(up_to_zero, eye_position(up_to_zero, {4095, 4095, 4095})));
}

TEST(eye_table, positions_outside_go_to_the_nearest_step) {
  const box cell{{0, 0, 0}, {4, 2, 4}};
  EXPECT_EQ(eye_at(cell, {-1, 1, 9}), (eye_steps{0, 2048, 4095}));
}

TEST(eye_table, files_without_eyes) {
  sample_contents contents = tiny_contents();
  eye_table eyes;
  EXPECT_EQ(open_eyes(contents.encode(), eyes), status::absent);
  add_viewpoints(contents, 1);
  EXPECT_EQ(open_eyes(contents.encode(), eyes), status::absent);
  EXPECT_EQ(open_eyes(golden_file("v0_small"), eyes), status::absent);
  EXPECT_EQ(eyes.count(0), 0u);
  eye_steps eye;
  EXPECT_EQ(eyes.eye(0, 0, eye), status::argument);
}

TEST(eye_table, the_writer_rejects) {
  const auto refused = [](const auto& change) {
    sample_contents contents = tiny_contents_with_eyes();
    change(contents.viewpoints[0].eyes);
    std::vector<std::byte> bytes;
    return encode(contents.view(), bytes);
  };
  EXPECT_EQ(refused([](auto&) {}), status::ok);
  EXPECT_EQ(refused([](auto& eyes) { eyes[1][2] = 4096; }), status::argument);
  EXPECT_EQ(refused([](auto& eyes) { eyes.resize(8); }), status::ok);
  EXPECT_EQ(refused([](auto& eyes) { eyes.resize(9); }), status::argument);
}

// open skips the section: a file whose eyes are damaged is a file without eyes, and its sets are not affected.
TEST(eye_table, damage_is_found_where_eyes_are_read) {
  const auto whole = tiny_contents_with_eyes().encode();
  const std::size_t begin = section_offset(whole, layout::section_eyes);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_eyes) + 16);
  eye_table eyes;
  int corrupt = 0;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    auto changed = whole;
    changed[begin + bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    EXPECT_EQ(open_eyes(changed, eyes), status::checksum);
    reseal(changed);
    const status s = open_eyes(changed, eyes);
    EXPECT_TRUE(s == status::ok || s == status::corrupt);
    corrupt += s == status::corrupt ? 1 : 0;
    for (std::uint32_t cell = 0; cell < 2 && s == status::ok; ++cell) {
      for (std::uint32_t number = 0; number < eyes.count(cell); ++number) {
        eye_steps eye;
        ASSERT_EQ(eyes.eye(cell, number, eye), status::ok);
        for (const std::uint16_t q : eye) EXPECT_LT(q, 4096);
      }
    }
  }
  EXPECT_GT(corrupt, 50);

  auto required = whole;
  set_u32(required, section_place(required, layout::section_eyes) + 4, 1);
  reseal(required);
  reader file;
  EXPECT_EQ(reader::open(required, file), status::version);
}

// Values are checked again when they are read again.
TEST(eye_table, bytes_that_change_later) {
  auto bytes = tiny_contents_with_eyes().encode();
  eye_table eyes;
  ASSERT_EQ(open_eyes(bytes, eyes), status::ok);
  const std::size_t begin = section_offset(bytes, layout::section_eyes);
  const std::size_t size = get_u64(bytes, section_place(bytes, layout::section_eyes) + 16);
  for (const int value : {0xFF, 0x55, 0x00}) {
    for (std::size_t i = 8; i < size; ++i) bytes[begin + i] = static_cast<std::byte>(value);
    for (std::uint32_t cell = 0; cell < 2; ++cell) {
      EXPECT_LE(eyes.count(cell), 8u);
      eye_steps eye{};
      static_cast<void>(eyes.eye(cell, 0, eye));
      for (const std::uint16_t q : eye) EXPECT_LT(q, 4096);
    }
  }
}

}  // namespace
