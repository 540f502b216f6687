#include "sightcell/format/file_parts.h"

#include <gtest/gtest.h>

#include "sample_contents.h"
#include "viewpoint_samples.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

// Encoding the parts with the sets gives exactly the same file.
void expect_same_file(const sample_contents& contents) {
  const auto bytes = contents.encode();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  file_parts parts;
  ASSERT_EQ(take_apart(file, parts), status::ok);
  std::vector<std::byte> again;
  ASSERT_EQ(encode(parts.contents(sets_of(contents.sets)), again), status::ok);
  EXPECT_TRUE(again == bytes);
}

TEST(file_parts, make_the_same_file_again) {
  expect_same_file({});
  expect_same_file(small_contents());
  sample_contents contents = random_contents(3, {.polygons = 500, .cells = 130, .overlapping = true});
  expect_same_file(contents);
  put_in_order(contents, 6);
  contents.facts.slack = 0.125f;
  expect_same_file(contents);
  put_on_grid(contents);
  expect_same_file(contents);
  put_on_lattice(contents);
  expect_same_file(contents);
  put_in_groups(contents, 7);
  expect_same_file(contents);
  contents.named_groups = {"door", "a", "lamp"};
  for (auto& d : contents.draws) d.named_group = d.group % 3 == 1 ? no_named_group : d.group % 3;
  expect_same_file(contents);
  add_volumes(contents, 100, 8);
  expect_same_file(contents);
  add_viewpoints(contents, 9);
  expect_same_file(contents);
  add_eyes(contents, 10);
  expect_same_file(contents);
  for (const draw_record& d : contents.draws) {
    if (d.polygon_count > 0) contents.geometry_hashes.push_back(d.first_source % 3);
  }
  contents.node_names = {"a", "ab", "abc", "b"};
  contents.mesh_names = {"b", "c"};
  expect_same_file(contents);
}

TEST(file_parts, of_version_0_are_those_it_was_written_from) {
  const auto bytes = golden_file("v0_small");
  sample_contents contents = small_contents();
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  file_parts parts;
  ASSERT_EQ(take_apart(file, parts), status::ok);
  EXPECT_FALSE(parts.lattice);
  EXPECT_EQ(parts.cells.size(), 67u);
  EXPECT_EQ(parts.settings, contents.settings);
  ASSERT_EQ(parts.certificate.size(), 67u);
  contents.certificate = parts.certificate;  // more exact than in version 1
  std::vector<std::byte> now;
  ASSERT_EQ(encode(parts.contents(sets_of(contents.sets)), now), status::ok);
  EXPECT_TRUE(now == contents.encode());
}

TEST(file_parts, damaged_orders_are_refused) {
  sample_contents contents = small_contents();
  put_in_order(contents, 1);
  auto bytes = contents.encode();
  const std::size_t place = section_place(bytes, layout::section_orders);
  const std::uint64_t end = get_u64(bytes, place + 8) + get_u64(bytes, place + 16);
  for (std::uint64_t at = end - 100; at < end - 20; ++at) bytes[at] = std::byte{0xFF};
  reseal(bytes);
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  file_parts parts;
  EXPECT_EQ(take_apart(file, parts), status::corrupt);
}

}  // namespace
