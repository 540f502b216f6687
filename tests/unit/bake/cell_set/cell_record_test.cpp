// Records as bytes: what goes in comes out, and no byte can be wrong unseen.
#include "cell_set/cell_record.h"

#include <gtest/gtest.h>

#include <limits>

#include "cell_set/cell_set.h"

namespace sightcell::bake {
namespace {

cell_record sample() {
  cell_record r;
  r.set = {0, 1, 2, 7, 8, 500, 0xFFFFFFFEu, 0xFFFFFFFFu};
  r.witnesses = {{1.5f, -2.0f, 0.0f}, {3.0f, 4.0f, std::numeric_limits<float>::denorm_min()}};
  r.witness_of = {0, 0, 1, 1, 0, 0, 0, 1};
  r.rays = std::numeric_limits<std::uint64_t>::max();
  r.misses = 3;
  r.upper_bound = 1.0 / 3.0;
  r.confidence = 0.975;
  r.samples = 24;
  r.valid_share = 0.1;
  r.bound_met = false;
  r.unverified = 3;
  r.found = {5, 0, 2, 0, 1, 0, 0xFFFFFFFFu};
  r.growth = {3, 0, 1, 1};
  r.growth.back() = 0xFFFFFFFFu;
  r.batches = 2;
  r.geometry_inside = true;
  r.late = {7, 500};
  r.eyes = {{0, 4095, 17}, {1, 256, 0}};
  return r;
}

TEST(cell_record, gives_back_what_went_in) {
  cell_record empty, solid, with_volumes = sample();
  solid.stored = false;
  with_volumes.volumes = {0, 1, 5, 0xFFFFFFu};
  for (const cell_record& r : {sample(), empty, solid, with_volumes}) EXPECT_EQ(decode(encode(r)), r);
}

TEST(cell_record, a_summary_is_read_without_the_set) {
  const auto summary = decode_summary(encode(sample()));
  ASSERT_TRUE(summary.has_value());
  EXPECT_EQ(summary->polygons, 8u);
  EXPECT_EQ(summary->misses, 3u);
  EXPECT_EQ(summary->upper_bound, 1.0 / 3.0);
  EXPECT_TRUE(summary->stored && summary->geometry_inside && !summary->bound_met);
}

TEST(cell_record, no_byte_can_be_wrong_and_no_end_missing) {
  const std::vector<std::uint8_t> good = encode(sample());
  for (std::size_t i = 0; i < good.size(); ++i) {
    auto bad = good;
    bad[i] ^= 0x10;
    EXPECT_FALSE(decode(bad).has_value()) << i;
    EXPECT_FALSE(decode_summary(bad).has_value()) << i;
    EXPECT_FALSE(decode(std::span(good).first(i)).has_value()) << i;
  }
}

TEST(cell_record, a_set_in_runs_takes_little) {
  // 30,000 polygons in runs of about ten, seen from 40 places in stretches: as a dense cell.
  cell_record r;
  for (std::uint32_t i = 0; r.set.size() < 30'000; ++i) {
    if (i % 25 < 10) r.set.push_back(i), r.witness_of.push_back(i / 50 % 40);
  }
  r.witnesses.resize(40);
  EXPECT_LT(encode(r).size(), 10'000u);
  EXPECT_EQ(decode(encode(r)), r);
}

TEST(cell_record, sets_come_back_with_their_witnesses) {
  cell_set set(1000);
  set.add_view({1, 2, 3}, {{10, 5, 0}, {12, 50, 0}, {900, 2, 0}});
  set.add_view({4, 5, 6}, {{10, 7, 0}, {12, 1, 0}});
  set.add(11, {0, 0, 9});
  cell_record saved;
  set.save(saved);
  EXPECT_EQ(saved.set, (std::vector<std::uint32_t>{10, 11, 12, 900}));
  EXPECT_EQ(saved.witnesses.size(), 3u);
  cell_set other(1000);
  other.add(77, {});
  other.load(saved);
  EXPECT_FALSE(other.contains(77));
  for (const std::uint32_t polygon : saved.set) EXPECT_EQ(other.witness(polygon), set.witness(polygon)) << polygon;
  cell_record again;
  other.save(again);
  EXPECT_EQ(again, saved);
}

TEST(cell_record, who_joined_first_decides_nothing) {
  const auto saved_after = [](std::vector<std::uint32_t> order) {
    cell_set set(10);
    for (const std::uint32_t polygon : order) set.add(polygon, glm::vec3(static_cast<float>(polygon % 2)));
    cell_record saved;
    set.save(saved);
    return encode(saved);
  };
  EXPECT_EQ(saved_after({1, 2, 3, 4}), saved_after({4, 2, 3, 1}));
}

}  // namespace
}  // namespace sightcell::bake
