#include "sightcell/format/identity_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_source.h"
#include "sample_contents.h"
#include "sightcell/format/geometry_hash.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

status open_identity(const std::vector<std::byte>& bytes, identity_table& out) {
  reader file;
  EXPECT_EQ(reader::open(bytes, file), status::ok);
  return identity_table::open(file, out);
}

std::vector<std::string> names_of(const identity_table& table) {
  std::vector<std::string> names;
  for (name_walk walk = table.names(); walk.next();) names.emplace_back(walk.name());
  return names;
}

sample_contents named_tiny_contents() {
  sample_contents contents = tiny_contents();  // one draw, of node 2 and mesh 1
  contents.geometry_hashes = {0x0123456789ABCDEFu};
  contents.node_names = {"not drawn", "", "Cube.001"};
  contents.mesh_names = {"", "Cube"};
  return contents;
}

// A name for each number, some of which are equal, and some missing.
std::vector<std::string> random_names(random_source& random, std::uint32_t count) {
  std::vector<std::string> names(count);
  for (std::string& name : names) {
    if (random.below(4) > 0) name = "object." + std::to_string(random.below(count));
  }
  return names;
}

TEST(identity_table, what_is_written_is_read) {
  sample_contents contents = random_contents(5, {.polygons = 300, .draws = 60, .cells = 20});
  random_source random(3);
  for (draw_record& d : contents.draws) {
    d.node = random.below(90);
    d.mesh = random.below(40);
    if (d.polygon_count > 0) contents.geometry_hashes.push_back(mixed(random.below(20)));
  }
  contents.node_names = random_names(random, 90);
  contents.mesh_names = random_names(random, 30);
  put_in_order(contents, 8);  // places are in source order all the same
  const auto bytes = contents.encode();
  identity_table table;
  ASSERT_EQ(open_identity(bytes, table), status::ok);
  ASSERT_EQ(table.draw_count(), contents.geometry_hashes.size());
  EXPECT_LE(table.hash_count(), 20u);
  for (std::uint32_t place = 0; place < table.draw_count(); ++place)
    EXPECT_EQ(table.hash(place), contents.geometry_hashes[place]);
  EXPECT_EQ(table.hash(table.draw_count()), 0u);
  const std::vector<std::string> names = names_of(table);
  ASSERT_EQ(names.size(), table.name_count());
  EXPECT_GT(names.size(), 20u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  const auto name_of = [&](std::uint32_t name) { return name == 0 ? std::string() : names[name - 1]; };
  for (const draw_record& d : contents.draws) {
    EXPECT_EQ(name_of(table.name_of_node(d.node)), contents.node_names[d.node]);
    EXPECT_EQ(name_of(table.name_of_mesh(d.mesh)), d.mesh < 30 ? contents.mesh_names[d.mesh] : "");
  }
}

TEST(identity_table, long_names_end_after_a_whole_character) {
  sample_contents contents = named_tiny_contents();
  contents.node_names[2] = std::string(254, 'a') + "\xC3\xBC";
  contents.mesh_names[1] = std::string(300, 'b');
  identity_table table;
  const auto bytes = contents.encode();
  ASSERT_EQ(open_identity(bytes, table), status::ok);
  EXPECT_EQ(names_of(table), (std::vector<std::string>{std::string(254, 'a'), std::string(255, 'b')}));
}

TEST(identity_table, files_without_it) {
  identity_table table;
  sample_contents contents = named_tiny_contents();
  contents.geometry_hashes.clear();
  EXPECT_EQ(open_identity(contents.encode(), table), status::absent);
  EXPECT_EQ(open_identity(golden_file("v0_small"), table), status::absent);
  EXPECT_EQ(table.draw_count(), 0u);
  EXPECT_EQ(table.hash(0), 0u);
  EXPECT_EQ(table.name_of_node(0), 0u);
  EXPECT_TRUE(names_of(table).empty());
}

TEST(identity_table, the_writer_rejects) {
  const auto refused = [](const auto& change) {
    sample_contents contents = named_tiny_contents();
    change(contents);
    std::vector<std::byte> bytes;
    return encode(contents.view(), bytes);
  };
  EXPECT_EQ(refused([](auto&) {}), status::ok);
  EXPECT_EQ(refused([](auto& c) { c.geometry_hashes.push_back(1); }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.node_names[2] = std::string("a\0b", 3); }), status::argument);
  EXPECT_EQ(refused([](auto& c) { c.node_names[0] = std::string("a\0b", 3); }), status::ok);  // no draw has it
}

// open skips the section: a file whose identity is damaged is a file without one.
TEST(identity_table, damage_is_found_where_it_is_read) {
  const auto whole = named_tiny_contents().encode();
  const std::size_t begin = section_offset(whole, layout::section_identity);
  const std::size_t size = get_u64(whole, section_place(whole, layout::section_identity) + 16);
  identity_table table;
  int corrupt = 0;
  for (std::size_t bit = 0; bit < 8 * size; ++bit) {
    auto changed = whole;
    changed[begin + bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    EXPECT_EQ(open_identity(changed, table), status::checksum);
    reseal(changed);
    const status s = open_identity(changed, table);
    EXPECT_TRUE(s == status::ok || s == status::corrupt);
    corrupt += s == status::corrupt ? 1 : 0;
    if (s != status::ok) continue;
    EXPECT_EQ(names_of(table).size(), table.name_count());
    EXPECT_LE(table.name_of_node(2), table.name_count());
  }
  EXPECT_GT(corrupt, 300);

  auto required = whole;
  set_u32(required, section_place(required, layout::section_identity) + 4, 1);
  reseal(required);
  reader file;
  EXPECT_EQ(reader::open(required, file), status::version);
}

TEST(identity_table, bytes_that_change_later) {
  auto bytes = named_tiny_contents().encode();
  identity_table table;
  ASSERT_EQ(open_identity(bytes, table), status::ok);
  const std::size_t begin = section_offset(bytes, layout::section_identity);
  const std::size_t size = get_u64(bytes, section_place(bytes, layout::section_identity) + 16);
  for (const int value : {0xFF, 0x55, 0x00}) {
    for (std::size_t i = 16; i < size; ++i) bytes[begin + i] = static_cast<std::byte>(value);
    EXPECT_LE(names_of(table).size(), table.name_count());
    for (std::uint32_t node = 0; node < 4; ++node) EXPECT_LE(table.name_of_node(node), table.name_count());
    static_cast<void>(table.hash(0));
  }
}

TEST(geometry_hash, is_the_one_of_the_specification) {
  EXPECT_EQ(triangle_hash({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}), 0x12E896D7D9D45428u);
}

TEST(geometry_hash, depends_on_corners_alone) {
  const std::array<float, 3> a{0, 1, 2}, b{-0.0f, 1, 2.5f}, c{3, -4, 5};
  const std::uint64_t hash = triangle_hash({a, b, c});
  EXPECT_NE(hash, 0u);
  EXPECT_EQ(triangle_hash({b, c, a}), hash);
  EXPECT_EQ(triangle_hash({c, b, a}), hash);
  EXPECT_EQ(triangle_hash({a, {0.0f, 1, 2.5f}, c}), hash);
  EXPECT_NE(triangle_hash({a, {1, 0.0f, 2.5f}, c}), hash);
  EXPECT_EQ(triangle_hash({a, b, a}), 0u);
  EXPECT_EQ(triangle_hash({a, a, b}), 0u);
}

}  // namespace
