// Draws of a host, found by their geometry and names.
#include "sightcell/identity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "loaded_file.h"
#include "sightcell/hosts/match.hpp"
#include "unit/format/random_source.h"

// A namespace of its own, because its short names would be those of other files that are compiled with it.
namespace sightcell::identity_test {
namespace {

using namespace sightcell::test;
using numbers = std::vector<std::uint32_t>;
constexpr std::uint32_t none = SIGHTCELL_NO_DRAW;

struct host_match {
  sightcell_status status = SIGHTCELL_OK;
  sightcell_draw_match counts{};
  numbers draw_of_host;
};

host_match match(const sightcell_db* db, const std::vector<std::uint64_t>& hashes,
                 const std::vector<const char*>& names = {}) {
  host_match out;
  out.counts.struct_size = sizeof out.counts;
  out.draw_of_host.resize(hashes.size(), 77);
  out.status = sightcell_db_match(db, hashes.data(), names.empty() ? nullptr : names.data(), hashes.size(),
                                  out.draw_of_host.data(), &out.counts);
  return out;
}

std::string name_of(const sightcell_db* db, std::uint32_t draw, std::uint32_t kind) {
  std::string name(255, '?');
  std::size_t count = 0;
  EXPECT_EQ(sightcell_db_draw_name(db, draw, kind, name.data(), name.size(), &count), SIGHTCELL_OK);
  name.resize(count);
  return name;
}

// Of the draws in stored order: two of group 0 with an empty one between them, one that moves, two of group 2. In
// source order: draw 4, 0, 5, 3, 2, with the hashes a b c d a.
constexpr std::uint64_t a = 0x0123456789ABCDEFu, b = 0xFEDCBA9876543210u, c = 1, d = std::uint64_t{1} << 63;

class identity : public testing::Test {
 protected:
  loaded_file file_{golden_file("v1_identity")};
  const sightcell_db* db_ = file_.db();
};

TEST_F(identity, hashes_and_names_of_draws) {
  const std::array<std::uint64_t, 6> expected{b, 0, a, d, a, c};
  for (std::uint32_t draw = 0; draw < 6; ++draw) {
    std::uint64_t hash = 5;
    EXPECT_EQ(sightcell_db_draw_hash(db_, draw, &hash), SIGHTCELL_OK);
    EXPECT_EQ(hash, expected[draw]) << draw;
  }
  EXPECT_EQ(name_of(db_, 0, SIGHTCELL_NAME_NODE), "Cube.001");
  EXPECT_EQ(name_of(db_, 1, SIGHTCELL_NAME_NODE), "Cube.0015");
  EXPECT_EQ(name_of(db_, 4, SIGHTCELL_NAME_NODE), "");
  EXPECT_EQ(name_of(db_, 4, SIGHTCELL_NAME_MESH), "Cube");
  EXPECT_EQ(name_of(db_, 2, SIGHTCELL_NAME_MESH), "");  // beyond the last mesh with a name
}

TEST_F(identity, draws_in_source_order) {
  const host_match all = match(db_, {a, b, c, d, a});
  EXPECT_EQ(all.status, SIGHTCELL_OK);
  EXPECT_EQ(all.draw_of_host, (numbers{4, 0, 5, 3, 2}));
  EXPECT_EQ(all.counts.matched, 5u);
  EXPECT_EQ(all.counts.by_order, 2u);
  EXPECT_EQ(all.counts.missing + all.counts.extra, 0u);
  EXPECT_EQ(all.counts.first_missing, none);
  EXPECT_EQ(all.counts.first_extra, none);
}

TEST_F(identity, draws_in_another_order_and_empty_ones) {
  const host_match all = match(db_, {d, 0, a, c, b, a, 0});
  EXPECT_EQ(all.status, SIGHTCELL_OK);
  EXPECT_EQ(all.draw_of_host, (numbers{3, none, 4, 5, 0, 2, none}));
}

// Without names, order would tell the two draws of one geometry from each other, and be wrong.
TEST_F(identity, names_come_before_order) {
  const host_match all = match(db_, {a, b, c, d, a}, {"Cube", "Cube.001", nullptr, "other", nullptr});
  EXPECT_EQ(all.status, SIGHTCELL_OK);
  EXPECT_EQ(all.draw_of_host, (numbers{2, 0, 5, 3, 4}));
  EXPECT_EQ(all.counts.by_order, 0u);
}

TEST_F(identity, another_scene_names_what_differs) {
  const host_match other = match(db_, {a, 17, b, a, a, c, 16});  // no d
  EXPECT_EQ(other.status, SIGHTCELL_ERR_OTHER_SCENE);
  EXPECT_EQ(other.draw_of_host, (numbers{4, none, 0, 2, none, 5, none}));
  EXPECT_EQ(other.counts.matched, 4u);
  EXPECT_EQ(other.counts.missing, 1u);
  EXPECT_EQ(other.counts.first_missing, 3u);
  EXPECT_EQ(other.counts.extra, 3u);
  EXPECT_EQ(other.counts.first_extra, 1u);

  const host_match nothing = match(db_, {});
  EXPECT_EQ(nothing.status, SIGHTCELL_ERR_OTHER_SCENE);
  EXPECT_EQ(nothing.counts.missing, 5u);
  EXPECT_EQ(nothing.counts.first_missing, 4u);  // in source order
}

TEST_F(identity, structs_of_other_sizes) {
  sightcell_draw_match small{};
  small.struct_size = sizeof small - 1;
  EXPECT_EQ(sightcell_db_match(db_, nullptr, nullptr, 0, nullptr, &small), SIGHTCELL_ERR_ARGUMENT);
}

// Many draws of few geometries, in any order: each is found, and those of one geometry stay in their order.
TEST(draw_match, random_scenes) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    random_source random(seed);
    sample_contents contents = random_contents(seed, {.polygons = 200, .draws = 50, .cells = 3});
    for (const auto& draw : contents.draws) {
      if (draw.polygon_count > 0) contents.geometry_hashes.push_back(1 + random.below(9));
    }
    put_in_order(contents, seed);
    const loaded_file file(contents);
    const host_match in_order = match(file.db(), contents.geometry_hashes);
    EXPECT_EQ(in_order.status, SIGHTCELL_OK);
    std::uint32_t before = 0;
    for (const std::uint32_t draw : in_order.draw_of_host) {
      EXPECT_GE(contents.draws[draw].first_source, before);
      before = contents.draws[draw].first_source;
    }
    std::vector<std::uint64_t> fewer = contents.geometry_hashes;
    fewer.pop_back();
    EXPECT_EQ(match(file.db(), fewer).counts.missing, 1u);
  }
}

struct vertex {
  std::array<std::uint8_t, 3> color;
  std::array<float, 3> position;
};

TEST(geometry_hash, of_meshes_that_importers_changed) {
  using sightcell::hosts::geometry_hash;
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5f, 0, 0, 0};
  const std::vector<std::uint32_t> indices{0, 1, 2, 1, 3, 2};
  const std::uint64_t whole = geometry_hash({.positions = positions, .indices = indices}).value_or(0);
  EXPECT_NE(whole, 0u);
  // In another order, turned over, with a vertex twice and a triangle without area.
  const std::vector<std::uint32_t> changed{2, 1, 3, 2, 1, 4, 0, 4, 2};
  EXPECT_EQ(geometry_hash({.positions = positions, .indices = changed}), whole);
  // The parts of a split mesh.
  const auto part = [&](std::size_t first) {
    return geometry_hash({.positions = positions, .indices = std::span(indices).subspan(first, 3)}).value_or(0);
  };
  EXPECT_EQ(part(0) + part(3), whole);
  EXPECT_NE(part(0), part(3));

  std::array<vertex, 4> interleaved{};
  for (std::size_t v = 0; v < 4; ++v)
    interleaved[v] = {{1, 2, 3}, {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]}};
  std::uint64_t hash = 0;
  EXPECT_EQ(sightcell_geometry_hash(&interleaved[0].position, sizeof(vertex), 4, indices.data(), 6, &hash),
            SIGHTCELL_OK);
  EXPECT_EQ(hash, whole);
  const std::vector<std::uint32_t> outside{0, 1, 5};
  EXPECT_FALSE(geometry_hash({.positions = positions, .indices = outside}).has_value());
}

}  // namespace
}  // namespace sightcell::identity_test
