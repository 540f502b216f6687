#include "volume_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "sightcell/format/cell_lattice.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell;
using format::lattice_place;
using format::lattice_shape;
using runtime::volume_index;
using test::random_source;
using place_key = std::tuple<std::int32_t, std::int32_t, std::int32_t>;

constexpr float infinity = std::numeric_limits<float>::infinity();

std::vector<std::byte> section_of(const lattice_shape& shape, const std::vector<lattice_place>& places) {
  std::vector<std::vector<std::uint32_t>> columns(3);
  for (const lattice_place& p : places) {
    columns[0].push_back(format::from_signed(p.x));
    columns[1].push_back(format::from_signed(p.y));
    columns[2].push_back(format::from_signed(p.z));
  }
  std::vector<std::byte> bytes;
  format::byte_sink out(bytes);
  out.put_f64(shape.width);
  out.put_f64(shape.height);
  out.put_u32(static_cast<std::uint32_t>(places.size()));
  format::put_columns(columns, bytes);
  return bytes;
}

// An index with its memory, and one view of it.
class built_index {
 public:
  built_index(const lattice_shape& shape, const std::vector<lattice_place>& places)
      : shape_(shape), places_(places), section_(section_of(shape, places)) {
    format::volume_table table;
    EXPECT_EQ(format::volume_table::open(section_, 0, table), format::status::ok);
    index_.measure(table);
    runtime::carver counted(nullptr);
    index_.carve(counted);
    memory_ = std::vector<std::max_align_t>(counted.used() / sizeof(std::max_align_t) + 1);
    memory_size = counted.used();
    runtime::carver space(memory_.data());
    index_.carve(space);
    EXPECT_EQ(space.used(), counted.used());
    EXPECT_TRUE(index_.build(table));
    visible_.resize(index_.chunk_count(), ~std::uint64_t{0});
    for (const lattice_place& p : places_) volumes_.insert(key_of(p));
    show({});
  }

  // Volumes by their numbers, ascending.
  void show(const std::vector<std::uint32_t>& volumes) {
    std::vector<format::run> runs;
    shown_.clear();
    for (const std::uint32_t v : volumes) {
      if (!runs.empty() && runs.back().first + runs.back().count == v) {
        ++runs.back().count;
      } else {
        runs.push_back({v, 1});
      }
      shown_.insert(key_of(places_[v]));
    }
    index_.show(runs, visible_);
  }

  [[nodiscard]] bool asks(const format::box& b) const {
    return index_.box_visible(b.min.data(), b.max.data(), visible_);
  }
  // The same by testing all positions around, of which those at the ends must be outside the box.
  [[nodiscard]] bool should_be(const format::box& b) const {
    std::array<std::vector<std::int32_t>, 3> touched;
    for (std::size_t axis = 0; axis < 3; ++axis) touched[axis] = touched_on(axis, b);
    for (const std::int32_t x : touched[0]) {
      for (const std::int32_t y : touched[1]) {
        for (const std::int32_t z : touched[2]) {
          if (!volumes_.contains({x, y, z}) || shown_.contains({x, y, z})) return true;
        }
      }
    }
    return false;
  }

  [[nodiscard]] const volume_index& index() const { return index_; }
  [[nodiscard]] const lattice_shape& shape() const { return shape_; }
  [[nodiscard]] const std::vector<lattice_place>& places() const { return places_; }
  std::uint64_t memory_size = 0;

 private:
  static place_key key_of(const lattice_place& p) { return {p.x, p.y, p.z}; }

  [[nodiscard]] std::vector<std::int32_t> touched_on(std::size_t axis, const format::box& b) const {
    const double size = axis == 1 ? shape_.height : shape_.width;
    const auto begin_of = [&](std::int64_t place) { return static_cast<float>(static_cast<double>(place) * size); };
    const auto place_of = [&](float at) {
      return static_cast<std::int64_t>(std::floor(static_cast<double>(at) / size));
    };
    std::vector<std::int32_t> touched;
    const std::int64_t from = place_of(b.min[axis]) - 70;
    const std::int64_t to = place_of(b.max[axis]) + 70;
    EXPECT_LT(begin_of(from + 1), b.min[axis]);
    EXPECT_GT(begin_of(to), b.max[axis]);
    for (std::int64_t place = from; place <= to; ++place) {
      if (begin_of(place) <= b.max[axis] && begin_of(place + 1) >= b.min[axis])
        touched.push_back(static_cast<std::int32_t>(place));
    }
    return touched;
  }

  lattice_shape shape_;
  std::vector<lattice_place> places_;
  std::vector<std::byte> section_;
  std::vector<std::max_align_t> memory_;
  volume_index index_;
  std::vector<std::uint64_t> visible_;
  std::set<place_key> volumes_, shown_;
};

// A block of positions with gaps, also where a position has no box.
std::vector<lattice_place> block_of(random_source& random, const lattice_shape& shape, const lattice_place& corner,
                                    std::int32_t width, std::uint32_t hole_in) {
  std::vector<lattice_place> places;
  for (std::int32_t y = 0; y < width; ++y) {
    for (std::int32_t z = 0; z < width; ++z) {
      for (std::int32_t x = 0; x < width; ++x) {
        const lattice_place p{corner.x + x, corner.y + y, corner.z + z, 0};
        if (random() % hole_in != 0 && format::is_volume_place(shape, p)) places.push_back(p);
      }
    }
  }
  return places;
}

// A number near the positions: at a border as often as not, and next to one as often.
float number_near(random_source& random, double size, std::int32_t corner, std::int32_t width) {
  const double place = corner - 1 + static_cast<double>(random() % static_cast<std::uint32_t>(width + 3));
  const auto border = static_cast<float>(place * size);
  switch (random() % 5) {
    case 0:
      return border;
    case 1:
      return std::nextafter(border, infinity);
    case 2:
      return std::nextafter(border, -infinity);
    default:
      return static_cast<float>((place + static_cast<double>(random() % 1000) / 1000.0) * size);
  }
}

format::box box_near(random_source& random, const lattice_shape& shape, const lattice_place& corner,
                     std::int32_t width) {
  format::box b;
  const std::int32_t corners[3] = {corner.x, corner.y, corner.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = axis == 1 ? shape.height : shape.width;
    const float from = number_near(random, size, corners[axis], width);
    const float longest = static_cast<float>(size) * static_cast<float>(random() % 3);
    float to = random() % 4 == 0 ? number_near(random, size, corners[axis], width) : from + longest;
    if (random() % 6 == 0) to = from;
    b.min[axis] = std::min(from, to);
    b.max[axis] = std::max(from, to);
  }
  return b;
}

void expect_as_by_trying_all(std::uint32_t seed, const lattice_shape& shape, const lattice_place& corner,
                             std::size_t least_hidden = 5) {
  SCOPED_TRACE(seed);
  random_source random(seed);
  const std::int32_t width = 3 + static_cast<std::int32_t>(random() % 8);
  const auto places = block_of(random, shape, corner, width, seed % 3 == 0 ? 5 : 1000);
  if (places.empty() && least_hidden == 0) return;
  built_index built(shape, places);
  std::size_t hidden = 0;
  for (int view = 0; view < 4; ++view) {
    std::vector<std::uint32_t> shown;
    for (std::uint32_t v = 0; v < built.places().size(); ++v) {
      if (view > 0 && random() % (view == 1 ? 40u : 4u) == 0) shown.push_back(v);
    }
    built.show(shown);
    for (int round = 0; round < 300; ++round) {
      const format::box b = box_near(random, shape, corner, width);
      const bool visible = built.asks(b);
      ASSERT_EQ(visible, built.should_be(b))
          << b.min[0] << " " << b.min[1] << " " << b.min[2] << " " << b.max[0] << " " << b.max[1] << " " << b.max[2];
      hidden += visible ? 0 : 1;
    }
  }
  EXPECT_GE(hidden, least_hidden);
}

TEST(volume_index, agrees_with_testing_every_position) {
  std::uint32_t seed = 1;
  for (const lattice_shape& shape :
       {lattice_shape{1.0, 1.0}, lattice_shape{1.25, 2.5}, lattice_shape{1.0 / 3.0, 0.7}, lattice_shape{0.1, 3.0e3}}) {
    for (const std::int32_t corner : {0, -5, -3, 17, -1000}) {
      expect_as_by_trying_all(seed++, shape, {corner, -corner / 2, corner + 1, 0});
    }
  }
}

// Where floats are a fourth of a position apart, and less: borders are rounded.
TEST(volume_index, far_positions_are_where_their_floats_are) {
  std::uint32_t seed = 100;
  for (const std::int32_t corner : {1 << 20, 1 << 21, -(1 << 21) - 4, 1 << 22}) {
    for (const lattice_shape& shape :
         {lattice_shape{1.0, 1.0}, lattice_shape{1.0 / 3.0, 0.7}, lattice_shape{1.1, 1.0e-3}}) {
      expect_as_by_trying_all(seed++, shape, {corner, corner, corner, 0});
    }
  }
}

// Further from the origin many positions have no box, so that none of them is a volume: a box touches several.
TEST(volume_index, positions_without_a_box_are_no_volumes) {
  std::uint32_t seed = 200;
  for (const std::int32_t corner : {1 << 23, (1 << 24) + 1, -(1 << 24) - 9, (1 << 25) + 3, -(1 << 27)}) {
    for (const lattice_shape& shape : {lattice_shape{1.0, 1.0}, lattice_shape{1.0 / 3.0, 0.7}, lattice_shape{1.1, 0.9}})
      expect_as_by_trying_all(seed++, shape, {corner, 3, -4, 0}, 0);
  }
  const lattice_shape shape{1.0, 1.0};
  const std::int32_t most = 1 << 30;
  for (const lattice_place& p : {lattice_place{most - 33, 0, 0, 0}, lattice_place{0, 0, -most + 32, 0}}) {
    const built_index built(shape, {p});
    const format::box b = format::box_of(shape, p);
    EXPECT_TRUE(built.asks(b));
    const format::box inside{{b.min[0] + 0.25f, 0.25f, b.min[2] + 0.25f}, {b.max[0] - 0.25f, 0.75f, b.max[2] - 0.25f}};
    EXPECT_TRUE(built.asks(inside)) << "on a border of others";
  }
}

// Borders of subnormal floats.
TEST(volume_index, positions_as_small_as_floats) {
  const auto least = static_cast<double>(std::numeric_limits<float>::denorm_min());
  for (const double size : {least, 1.5 * least, 2.25 * least, 0x1p-126})
    expect_as_by_trying_all(31, {size, size}, {-4, -3, -2, 0});
  for (const double size : {0.75 * least, 0.3 * least}) expect_as_by_trying_all(32, {size, size}, {-4, -3, -2, 0}, 0);
  expect_as_by_trying_all(32, {0x1p100, 0x1p104}, {-4, -3, -2, 0});
}

TEST(volume_index, a_point_on_a_border_touches_both_positions) {
  built_index built({2.0, 3.0}, {{-1, 0, 0, 0}, {0, 0, 0, 0}});
  const auto asks_at = [&](float x, float y, float z) { return built.asks({{x, y, z}, {x, y, z}}); };
  EXPECT_FALSE(asks_at(0.0f, 1.0f, 1.0f)) << "both are hidden";
  EXPECT_FALSE(asks_at(-0.0f, 1.0f, 1.0f));
  EXPECT_FALSE(asks_at(1.0f, 1.0f, 1.0f));
  EXPECT_TRUE(asks_at(2.0f, 1.0f, 1.0f)) << "the next position is no volume";
  EXPECT_TRUE(asks_at(-2.0f, 1.0f, 1.0f));
  EXPECT_TRUE(asks_at(1.0f, 0.0f, 1.0f));
  EXPECT_TRUE(asks_at(1.0f, 3.0f, 1.0f));
  EXPECT_TRUE(asks_at(1.0f, 1.0f, 2.0f));
  built.show({1});
  EXPECT_TRUE(asks_at(0.0f, 1.0f, 1.0f));
  EXPECT_TRUE(asks_at(1.0f, 1.0f, 1.0f));
  EXPECT_FALSE(asks_at(-1.0f, 1.0f, 1.0f));
  built.show({0});
  EXPECT_TRUE(asks_at(0.0f, 1.0f, 1.0f));
  EXPECT_FALSE(asks_at(1.0f, 1.0f, 1.0f));
}

TEST(volume_index, large_boxes) {
  random_source random(3);
  built_index built({1.0, 1.0}, block_of(random, {1.0, 1.0}, {-20, -20, -20, 0}, 40, 0xFFFFFFFFu));
  EXPECT_EQ(built.places().size(), 64000u);
  EXPECT_EQ(built.index().chunk_count(), 1000u);
  constexpr float almost = 19.875f;
  EXPECT_FALSE(built.asks({{-almost, -almost, -almost}, {almost, almost, almost}}));
  EXPECT_TRUE(built.asks({{-almost, -almost, -almost}, {almost, almost, 20.0f}}));
  EXPECT_TRUE(built.asks({{-almost, -3.0e38f, -almost}, {almost, 3.0e38f, almost}}));
  EXPECT_TRUE(built.asks({{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}));
  EXPECT_TRUE(built.asks({{-infinity, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}}));
  EXPECT_TRUE(built.asks({{infinity, 0.5f, 0.5f}, {infinity, 0.5f, 0.5f}}));
  EXPECT_TRUE(built.asks({{-3.0e38f, 0.5f, 0.5f}, {-3.0e38f, 0.5f, 0.5f}}));
  const float last = std::numeric_limits<float>::max();
  EXPECT_TRUE(built.asks({{0.5f, last, 0.5f}, {0.5f, last, 0.5f}}));
  for (const float distance : {1.0e9f, 1.0e12f, 3.0e38f, infinity}) {
    EXPECT_TRUE(built.asks({{0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, distance}})) << distance;
    EXPECT_TRUE(built.asks({{0.5f, -distance, 0.5f}, {0.5f, 0.5f, 0.5f}})) << distance;
    EXPECT_TRUE(built.asks({{distance, 0.5f, 0.5f}, {distance, 0.5f, 0.5f}})) << distance;
  }
  built.show({63999});
  EXPECT_TRUE(built.asks({{-almost, -almost, -almost}, {almost, almost, almost}}));
  EXPECT_FALSE(built.asks({{-almost, -almost, -almost}, {almost, almost, 18.5f}}));
}

TEST(volume_index, what_is_no_box_is_visible) {
  const built_index built({1.0, 1.0}, {{0, 0, 0, 0}});
  const float nan = std::nanf("");
  EXPECT_FALSE(built.asks({{0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}}));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    format::box b{{0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}};
    EXPECT_TRUE(volume_index::is_box(b.min.data(), b.max.data()));
    b.min[axis] = 0.75f;
    EXPECT_FALSE(volume_index::is_box(b.min.data(), b.max.data()));
    EXPECT_TRUE(built.asks(b));
    b.min[axis] = nan;
    EXPECT_FALSE(volume_index::is_box(b.min.data(), b.max.data()));
    EXPECT_TRUE(built.asks(b));
    b.min[axis] = 0.25f;
    b.max[axis] = nan;
    EXPECT_FALSE(volume_index::is_box(b.min.data(), b.max.data()));
    EXPECT_TRUE(built.asks(b));
  }
}

TEST(volume_index, without_volumes_all_is_visible) {
  volume_index index;
  index.measure({});
  runtime::carver space(nullptr);
  index.carve(space);
  EXPECT_EQ(space.used(), 0u);
  EXPECT_TRUE(index.build({}));
  EXPECT_EQ(index.chunk_count(), 0u);
  const float at[3] = {0, 0, 0};
  index.show({}, {});
  EXPECT_TRUE(index.box_visible(at, at, {}));
}

// No writer produces this, and only a check of the whole file finds it.
TEST(volume_index, two_volumes_at_one_place) {
  built_index built({1.0, 1.0}, {{0, 0, 0, 0}, {5, 0, 0, 0}, {0, 0, 0, 0}});
  const format::box b{{0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}};
  EXPECT_FALSE(built.asks(b));
  built.show({0});
  EXPECT_TRUE(built.asks(b));
  built.show({2});
  EXPECT_TRUE(built.asks(b));
  built.show({1});
  EXPECT_FALSE(built.asks(b));
}

TEST(volume_index, memory_follows_the_chunks) {
  random_source random(4);
  const built_index dense({1.0, 1.0}, block_of(random, {1.0, 1.0}, {0, 0, 0, 0}, 32, 0xFFFFFFFFu));
  EXPECT_EQ(dense.index().chunk_count(), 512u);
  EXPECT_LE(dense.memory_size, 4u * 32768u + 4u * 512u * 2u * sizeof(runtime::volume_chunk));
  std::vector<lattice_place> scattered;
  for (std::int32_t i = 0; i < 5000; ++i) scattered.push_back({i * 977 % 5000 * 4, i % 7 * 40, i * 4, 0});
  const built_index thin({1.0, 1.0}, scattered);
  EXPECT_EQ(thin.index().chunk_count(), 5000u);
  EXPECT_LE(thin.memory_size, 4u * 5000u + 16384u * sizeof(runtime::volume_chunk));
}

TEST(volume_index, runs_beyond_the_volumes_and_small_views) {
  built_index built({1.0, 1.0}, {{0, 0, 0, 0}, {9, 0, 0, 0}});
  std::vector<std::uint64_t> visible(built.index().chunk_count(), 0);
  const std::vector<format::run> runs{{1, 0xFFFFFFFFu}, {0xFFFFFFFFu, 0xFFFFFFFFu}};
  built.index().show(runs, visible);
  const float at[3] = {0.5f, 0.5f, 0.5f};
  const float there[3] = {9.5f, 0.5f, 0.5f};
  EXPECT_FALSE(built.index().box_visible(at, at, visible));
  EXPECT_TRUE(built.index().box_visible(there, there, visible));
  EXPECT_TRUE(built.index().box_visible(at, at, std::span(visible).first(1))) << "a view of another file";
}

TEST(volume_index, bytes_that_are_no_positions_any_more) {
  constexpr std::int32_t most = 1 << 30;
  auto bytes = section_of({1.0, 1.0}, {{-most + 32, 0, 0, 0}, {most - 33, 0, 0, 0}});
  format::volume_table table;
  ASSERT_EQ(format::volume_table::open(bytes, 0, table), format::status::ok);
  volume_index index;
  index.measure(table);
  runtime::carver counted(nullptr);
  index.carve(counted);
  const auto memory = std::make_unique<std::byte[]>(counted.used());
  runtime::carver space(memory.get());
  index.carve(space);
  std::fill_n(bytes.begin() + 44, 8, std::byte{0xFF});  // two x of 31 bits: beyond the last position
  EXPECT_FALSE(index.build(table));
  EXPECT_EQ(index.chunk_count(), 0u);
  const float at[3] = {0.5f, 0.5f, 0.5f};
  EXPECT_TRUE(index.box_visible(at, at, {}));
}

// The measured sizes are used, whatever the bytes become.
TEST(volume_index, bytes_that_change_meanwhile) {
  random_source random(5);
  const std::vector<lattice_place> few(400, lattice_place{1, 2, 3, 0});
  auto bytes = section_of({1.0, 1.0}, few);
  // Columns of 12 bits, all zeros so far.
  const std::vector<lattice_place> ends{{0, 0, 0, 0}, {4095, 4095, 4095, 0}};
  const auto wide = section_of({1.0, 1.0}, ends);
  std::copy(wide.begin() + 20, wide.begin() + 44, bytes.begin() + 20);
  bytes.resize(44 + std::size_t{3} * (400 * 12 / 8));
  for (int round = 0; round < 200; ++round) {
    auto changing = bytes;
    format::volume_table table;
    ASSERT_EQ(format::volume_table::open(changing, 0, table), format::status::ok);
    volume_index index;
    index.measure(table);
    runtime::carver counted(nullptr);
    index.carve(counted);
    const auto memory = std::make_unique<std::byte[]>(counted.used());
    runtime::carver space(memory.get());
    index.carve(space);
    for (int n = 0; n < 1000; ++n) changing[44 + random() % (changing.size() - 44)] = static_cast<std::byte>(random());
    ASSERT_TRUE(index.build(table));
    EXPECT_LE(index.chunk_count(), 2u) << "no more than there is room for";
    std::vector<std::uint64_t> visible(index.chunk_count());
    const std::vector<format::run> all{{0, 400}};
    index.show(all, visible);
    const float at[3] = {0.5f, 0.5f, 0.5f};
    static_cast<void>(index.box_visible(at, at, visible));
  }
}

}  // namespace
