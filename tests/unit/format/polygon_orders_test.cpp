#include "polygon_orders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "bit_reader.h"
#include "byte_sink.h"
#include "code_lengths.h"
#include "code_table_writer.h"
#include "packed_columns_writer.h"
#include "polygon_orders_writer.h"
#include "random_source.h"

namespace {

using namespace sightcell::format;
using sightcell::test::random_source;

using order_list = std::vector<std::vector<std::uint32_t>>;

// Parts of the source order, mixed.
std::vector<std::uint32_t> random_order(random_source& random, std::uint32_t polygons) {
  std::vector<std::uint32_t> order(polygons);
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i = polygons; i > 1; --i) {
    if (random() % 3 == 0) std::swap(order[i - 1], order[random() % i]);
  }
  return order;
}

order_list some_orders(std::uint32_t seed) {
  random_source random(seed);
  order_list orders;
  for (const std::uint32_t polygons : {1u, 0u, 300u, 7u, 2u, 1000u, 0u})
    orders.push_back(random_order(random, polygons));
  return orders;
}

// In memory of exactly this size, so that the sanitizer detects a load after its end.
std::vector<std::byte> written(const order_list& orders) {
  std::vector<std::byte> bytes;
  put_orders(orders, bytes);
  bytes.shrink_to_fit();
  return bytes;
}

TEST(polygon_orders, orders_come_back) {
  const auto orders = some_orders(1);
  const auto bytes = written(orders);
  const polygon_orders read(bytes, 100);
  ASSERT_TRUE(read.good());
  ASSERT_EQ(read.count(), orders.size());
  std::uint32_t polygons = 0;
  for (std::uint32_t n = 0; n < orders.size(); ++n) {
    EXPECT_EQ(read.first_polygon(n), polygons);
    ASSERT_EQ(read.polygon_count(n), orders[n].size());
    std::vector<std::uint32_t> got(orders[n].size());
    ASSERT_TRUE(read.source_of_stored(n, got));
    EXPECT_EQ(got, orders[n]);
    polygons += read.polygon_count(n);
  }
  EXPECT_EQ(read.polygons(), polygons);
}

TEST(polygon_orders, no_orders_at_all) {
  const auto bytes = written({});
  const polygon_orders read(bytes, 100);
  ASSERT_TRUE(read.good());
  EXPECT_EQ(read.count(), 0u);
  EXPECT_EQ(read.polygons(), 0u);
  EXPECT_FALSE(polygon_orders({}, 100).good());
}

TEST(polygon_orders, the_order_of_the_source_takes_a_bit_a_polygon) {
  order_list orders(1, std::vector<std::uint32_t>(80'000));
  std::iota(orders[0].begin(), orders[0].end(), 0u);
  EXPECT_LT(written(orders).size(), 10'100u);
}

TEST(polygon_orders, spans_of_another_size) {
  const auto bytes = written(some_orders(2));
  const polygon_orders read(bytes, 100);
  ASSERT_TRUE(read.good());
  std::vector<std::uint32_t> few(read.polygon_count(2) - 1), many(read.polygon_count(2) + 1);
  EXPECT_FALSE(read.source_of_stored(2, few));
  EXPECT_FALSE(read.source_of_stored(2, many));
  EXPECT_FALSE(read.source_of_stored(read.count(), {}));
}

TEST(polygon_orders, no_more_than_there_can_be) {
  const auto bytes = written(some_orders(5));
  EXPECT_TRUE(polygon_orders(bytes, 7).good());
  EXPECT_FALSE(polygon_orders(bytes, 6).good());
}

TEST(polygon_orders, all_of_their_bytes_are_used) {
  std::vector<std::byte> bytes;
  byte_sink(bytes).put_u32(1);
  put_columns(std::vector<std::vector<std::uint32_t>>{{0, 8}, {0, 2}}, bytes);
  symbol_counts counts{};
  counts[0] = 1;
  put_code_lengths(best_lengths(counts), bytes);
  bytes.insert(bytes.end(), 2 + bit_reader::padding, std::byte{0});
  const polygon_orders read(bytes, 1);
  ASSERT_TRUE(read.good());
  std::vector<std::uint32_t> order(8);
  EXPECT_FALSE(read.source_of_stored(0, order)) << "eight bits are one byte, not two";
}

TEST(polygon_orders, cut_at_every_length) {
  const auto bytes = written(some_orders(3));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(polygon_orders(cut, 100).good()) << size;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(polygon_orders(longer, 100).good());
}

// A host allocates memory for orders before it reads them: few bytes must not claim many polygons.
TEST(polygon_orders, polygons_without_bits_are_refused) {
  const auto named = [](std::uint32_t polygons, std::uint32_t bytes_of_first) {
    std::vector<std::byte> bytes;
    byte_sink(bytes).put_u32(2);
    put_columns(std::vector<std::vector<std::uint32_t>>{{0, polygons, polygons}, {0, bytes_of_first, 100}}, bytes);
    symbol_counts counts{};
    counts[0] = 1;
    put_code_lengths(best_lengths(counts), bytes);
    bytes.insert(bytes.end(), 100 + bit_reader::padding, std::byte{0});
    return polygon_orders(bytes, 100).good();
  };
  EXPECT_TRUE(named(800, 100));
  EXPECT_FALSE(named(801, 100));
  EXPECT_FALSE(named(800, 99)) << "the bits of one order are not those of another";
  EXPECT_FALSE(named(8, 101)) << "an order begins behind the end";
}

// For any bytes: rejected, or orders that follow each other and name existing polygons.
TEST(polygon_orders, changed_bytes_make_orders_or_errors) {
  random_source random(4);
  const auto bytes = written(some_orders(4));
  int whole = 0, refused = 0;
  for (int round = 0; round < 10000; ++round) {
    auto changed = bytes;
    changed[random() % changed.size()] = static_cast<std::byte>(random());
    const polygon_orders read(changed, 100);
    if (!read.good()) {
      ++refused;
      continue;
    }
    bool good = true;
    for (std::uint32_t n = 0; n < read.count(); ++n) {
      ASSERT_LE(read.first_polygon(n), read.first_polygon(n + 1));
      std::vector<std::uint32_t> order(read.polygon_count(n));
      if (!read.source_of_stored(n, order)) {
        good = false;
        continue;
      }
      for (const std::uint32_t p : order) ASSERT_LT(p, order.size());
    }
    whole += good ? 1 : 0;
  }
  EXPECT_GT(whole, 100);
  EXPECT_GT(refused, 100);
}

}  // namespace
