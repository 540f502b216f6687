#include "row_encoder.h"

#include <gtest/gtest.h>

#include "random_source.h"
#include "row_decoder.h"

namespace {

using namespace sightcell::format;

std::vector<std::uint32_t> random_set(sightcell::test::random_source& random, std::uint32_t polygons, unsigned one_in) {
  std::vector<std::uint32_t> set;
  bool in = false;
  for (std::uint32_t p = 0; p < polygons; ++p) {
    if (random() % one_in == 0) in = !in;
    if (in) set.push_back(p);
  }
  return set;
}

bool same(std::span<const run> a, std::span<const run> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const run& x, const run& y) { return x.first == y.first && x.count == y.count; });
}

TEST(row_encoder, runs_are_as_long_as_they_can_be) {
  const std::vector<std::uint32_t> set{0, 1, 2, 5, 7, 8};
  const std::vector<run> expected{{0, 3}, {5, 1}, {7, 2}};
  EXPECT_TRUE(same(runs_of(set), expected));
  EXPECT_TRUE(runs_of({}).empty());
}

TEST(row_encoder, difference_is_what_sets_say) {
  sightcell::test::random_source random(3);
  std::vector<run> removed;
  std::vector<run> added;
  for (unsigned round = 0; round < 300; ++round) {
    const auto a = random_set(random, 120, 2 + round % 9);
    const auto b = random_set(random, 120, 2 + round % 5);
    difference(runs_of(a), runs_of(b), removed, added);
    std::vector<std::uint32_t> only_a;
    std::vector<std::uint32_t> only_b;
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only_a));
    std::set_difference(b.begin(), b.end(), a.begin(), a.end(), std::back_inserter(only_b));
    ASSERT_TRUE(same(removed, runs_of(only_a)));
    ASSERT_TRUE(same(added, runs_of(only_b)));
  }
}

TEST(row_encoder, own_rows_come_back) {
  sightcell::test::random_source random(1);
  for (int round = 0; round < 500; ++round) {
    const std::uint32_t polygons = random() % 3000;
    const auto set = runs_of(random_set(random, polygons, 1 + random() % 40));
    std::vector<std::byte> bytes;
    encode_own_row(set, bytes);
    ASSERT_EQ(bytes.size(), own_row_size(set));
    row_header header;
    ASSERT_TRUE(read_row_header(bytes, header));
    ASSERT_FALSE(header.delta);
    std::vector<run> out(set.size());
    std::size_t count = 0;
    ASSERT_EQ(decode_own_row(header, polygons, out, count), status::ok);
    ASSERT_EQ(count, set.size());
    ASSERT_TRUE(same(out, set));
  }
}

TEST(row_encoder, delta_rows_come_back) {
  sightcell::test::random_source random(2);
  std::vector<run> removed;
  std::vector<run> added;
  for (int round = 0; round < 500; ++round) {
    const std::uint32_t polygons = random() % 3000;
    const auto reference = runs_of(random_set(random, polygons, 1 + random() % 40));
    const auto set = runs_of(random_set(random, polygons, 1 + random() % 40));
    difference(reference, set, removed, added);
    std::vector<std::byte> bytes;
    encode_delta_row(17, removed, added, bytes);
    ASSERT_EQ(bytes.size(), delta_row_size(removed, added));
    row_header header;
    ASSERT_TRUE(read_row_header(bytes, header));
    ASSERT_TRUE(header.delta);
    ASSERT_EQ(header.reference, 17u);
    std::vector<run> out(set.size());
    std::size_t count = 0;
    ASSERT_EQ(decode_delta_row(header, polygons, reference, out, count), status::ok);
    ASSERT_EQ(count, set.size());
    ASSERT_TRUE(same(out, set));
  }
}

TEST(row_encoder, the_highest_polygon) {
  const std::vector<run> set{{0, 1}, {0xFFFFFFFDu, 1}};
  std::vector<std::byte> bytes;
  encode_own_row(set, bytes);
  row_header header;
  ASSERT_TRUE(read_row_header(bytes, header));
  std::vector<run> out(2);
  std::size_t count = 0;
  EXPECT_EQ(decode_own_row(header, 0xFFFFFFFEu, out, count), status::ok);
  EXPECT_TRUE(same(out, set));
  EXPECT_EQ(decode_own_row(header, 0xFFFFFFFDu, out, count), status::corrupt);
}

}  // namespace
