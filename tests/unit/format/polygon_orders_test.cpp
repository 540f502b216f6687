#include "polygon_orders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "packed_columns.h"
#include "polygon_orders_writer.h"
#include "random_source.h"

namespace {

using namespace sightcell::format;
using sightcell::test::random_source;

polygon_order random_order(random_source& random, std::uint32_t polygons, std::uint32_t per_atom) {
  polygon_order order;
  order.source_of_stored.resize(polygons);
  std::iota(order.source_of_stored.begin(), order.source_of_stored.end(), 0u);
  for (std::uint32_t i = polygons; i > 1; --i) {
    if (random() % 3 != 0) std::swap(order.source_of_stored[i - 1], order.source_of_stored[random() % i]);
  }
  for (std::uint32_t i = 0; i < polygons; ++i) order.begins_atom.push_back(i == 0 || random() % per_atom == 0);
  sort_atoms(order);
  return order;
}

std::vector<polygon_order> some_orders(std::uint32_t seed) {
  random_source random(seed);
  std::vector<polygon_order> orders;
  for (const std::uint32_t polygons : {1u, 0u, 300u, 7u, 2u, 1000u})
    orders.push_back(random_order(random, polygons, 3));
  orders.push_back(random_order(random, 100, 1));
  orders.push_back(random_order(random, 100, 1000));
  return orders;
}

// In memory of exactly that size, so that the sanitizer sees a load behind it.
std::vector<std::byte> written(std::span<const polygon_order> orders) {
  std::vector<std::byte> bytes;
  put_orders(orders, bytes);
  bytes.shrink_to_fit();
  return bytes;
}

std::vector<std::uint32_t> begins_of(const polygon_order& order) {
  std::vector<std::uint32_t> begins;
  for (std::uint32_t i = 0; i < order.begins_atom.size(); ++i) {
    if (order.begins_atom[i]) begins.push_back(i);
  }
  return begins;
}

// Reads everything. Nothing when the section is refused.
bool reads_back(std::span<const std::byte> bytes, std::vector<polygon_order>& out) {
  polygon_orders read;
  if (!read.open(bytes)) return false;
  out.clear();
  for (std::uint32_t n = 0; n < read.count(); ++n) {
    std::vector<std::uint32_t> begins(read.atom_count(n));
    polygon_order order;
    order.source_of_stored.resize(read.polygon_count(n));
    if (!read.atom_begins(n, begins) || !read.source_of_stored(n, order.source_of_stored)) return false;
    order.begins_atom.resize(read.polygon_count(n));
    for (const std::uint32_t begin : begins) order.begins_atom.at(begin) = true;
    out.push_back(order);
  }
  return true;
}

TEST(polygon_orders, orders_and_atoms_come_back) {
  const auto orders = some_orders(1);
  const auto bytes = written(orders);
  polygon_orders read;
  ASSERT_TRUE(read.open(bytes));
  ASSERT_EQ(read.count(), orders.size());
  std::uint32_t polygons = 0, atoms = 0;
  for (std::uint32_t n = 0; n < orders.size(); ++n) {
    const auto begins = begins_of(orders[n]);
    EXPECT_EQ(read.first_polygon(n), polygons);
    EXPECT_EQ(read.first_atom(n), atoms);
    ASSERT_EQ(read.polygon_count(n), orders[n].source_of_stored.size());
    ASSERT_EQ(read.atom_count(n), begins.size());
    std::vector<std::uint32_t> got(begins.size());
    ASSERT_TRUE(read.atom_begins(n, got));
    EXPECT_EQ(got, begins);
    got.resize(orders[n].source_of_stored.size());
    ASSERT_TRUE(read.source_of_stored(n, got));
    EXPECT_EQ(got, orders[n].source_of_stored);
    polygons += read.polygon_count(n);
    atoms += read.atom_count(n);
  }
  EXPECT_EQ(read.polygons(), polygons);
  EXPECT_EQ(read.atoms(), atoms);
}

TEST(polygon_orders, no_orders_at_all) {
  const auto bytes = written({});
  polygon_orders read;
  ASSERT_TRUE(read.open(bytes));
  EXPECT_EQ(read.count(), 0u);
  EXPECT_EQ(read.polygons(), 0u);
  EXPECT_FALSE(read.open({}));
}

TEST(polygon_orders, the_order_of_the_source_takes_a_bit_a_polygon) {
  polygon_order order;
  order.source_of_stored.resize(80'000);
  std::iota(order.source_of_stored.begin(), order.source_of_stored.end(), 0u);
  order.begins_atom.assign(80'000, true);
  const auto bytes = written(std::span(&order, 1));
  EXPECT_LT(bytes.size(), 20'100u);  // and one for its atom
}

TEST(polygon_orders, every_order_begins_with_an_atom) {
  auto orders = some_orders(5);
  EXPECT_TRUE(polygon_orders().open(written(orders)));
  orders[2].begins_atom[0] = false;
  EXPECT_FALSE(polygon_orders().open(written(orders)));
}

// An atom more or less in one order, which another one may make up for.
TEST(polygon_orders, orders_have_as_many_atoms_as_begin_in_them) {
  const auto orders = some_orders(6);
  auto bytes = written(orders);
  std::uint64_t size = 0;
  ASSERT_TRUE(
      packed_columns::size_of(std::span(bytes).subspan(4), 3, static_cast<std::uint32_t>(orders.size()) + 1, size));
  const std::size_t atoms = 4 + static_cast<std::size_t>(size);
  const std::byte before = bytes[atoms + 2];
  for (int bit = 0; bit < 8; ++bit) {
    bytes[atoms + 2] = before ^ static_cast<std::byte>(1 << bit);
    EXPECT_FALSE(polygon_orders().open(bytes)) << bit;
  }
}

TEST(polygon_orders, spans_of_another_size) {
  const auto orders = some_orders(2);
  const auto bytes = written(orders);
  polygon_orders read;
  ASSERT_TRUE(read.open(bytes));
  std::vector<std::uint32_t> few(read.atom_count(2) - 1), many(read.atom_count(2) + 1);
  EXPECT_FALSE(read.atom_begins(2, few));
  EXPECT_FALSE(read.atom_begins(2, many));
  few.resize(read.polygon_count(2) - 1);
  EXPECT_FALSE(read.source_of_stored(2, few));
  EXPECT_FALSE(read.source_of_stored(read.count(), few));
  EXPECT_FALSE(read.atom_begins(read.count(), few));
}

TEST(polygon_orders, cut_at_every_length) {
  const auto bytes = written(some_orders(3));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(polygon_orders().open(cut)) << size;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(polygon_orders().open(longer));
}

// Whatever the bytes: refused, or atoms that begin with 0 and ascend, and polygons that there are.
TEST(polygon_orders, changed_bytes_make_orders_or_errors) {
  random_source random(4);
  const auto bytes = written(some_orders(4));
  int accepted = 0;
  for (int round = 0; round < 10000; ++round) {
    auto changed = bytes;
    changed[random() % changed.size()] = static_cast<std::byte>(random());
    std::vector<polygon_order> orders;
    if (!reads_back(changed, orders)) continue;
    ++accepted;
    for (const polygon_order& order : orders) {
      ASSERT_TRUE(order.begins_atom.empty() || order.begins_atom.front());
      for (const std::uint32_t p : order.source_of_stored) ASSERT_LT(p, order.source_of_stored.size());
    }
  }
  EXPECT_GT(accepted, 100);
}

}  // namespace
