#include "cells/reach.h"

#include <gtest/gtest.h>

#include <vector>

namespace sightcell::bake {
namespace {

constexpr std::int32_t sky = 1000;

// A field of columns along x, each with the spaces given from the lowest up.
open_field row_of(const std::vector<std::vector<open_space>>& columns) {
  open_field field{.width = columns.size(), .depth = 1, .begins = {}, .spaces = {}};
  for (const std::vector<open_space>& column : columns) {
    field.begins.push_back(static_cast<std::uint32_t>(field.spaces.size()));
    field.spaces.insert(field.spaces.end(), column.begin(), column.end());
  }
  field.begins.push_back(static_cast<std::uint32_t>(field.spaces.size()));
  return field;
}

open_space floor_at(std::int32_t floor, std::int32_t ceiling = sky) {
  return {floor, ceiling, true};
}
open_space slope_at(std::int32_t floor) {
  return {floor, sky, false};
}

const player_moves person{.height = 18, .step = 4, .jump = 12, .gap = 4};

std::vector<int> reached_from(const open_field& field, std::uint32_t start, const player_moves& moves = person) {
  const std::vector<std::uint32_t> starts{start};
  const std::vector<std::uint8_t> reached = find_reached(field, moves, starts);
  return {reached.begin(), reached.end()};
}

TEST(reach, steps_are_climbed_and_walls_are_not) {
  const open_field stairs = row_of({{floor_at(0)}, {floor_at(4)}, {floor_at(8)}, {floor_at(30)}, {floor_at(30)}});
  EXPECT_EQ(reached_from(stairs, 0), (std::vector<int>{1, 1, 1, 0, 0}));
}

TEST(reach, a_jump_gets_up_a_ledge) {
  const open_field ledge = row_of({{floor_at(0)}, {floor_at(12)}, {floor_at(25)}});
  EXPECT_EQ(reached_from(ledge, 0), (std::vector<int>{1, 1, 0}));
  EXPECT_EQ(reached_from(ledge, 0, {.height = 18, .step = 4, .jump = 4, .gap = 0}), (std::vector<int>{1, 0, 0}));
}

TEST(reach, a_fall_leads_down_and_not_back) {
  const open_field roof = row_of({{floor_at(0)}, {floor_at(90)}, {floor_at(0)}});
  EXPECT_EQ(reached_from(roof, 0), (std::vector<int>{1, 0, 0}));
  EXPECT_EQ(reached_from(roof, 1), (std::vector<int>{1, 1, 1}));
}

TEST(reach, low_ceilings_block) {
  const open_field door = row_of({{floor_at(0)}, {floor_at(0, 17)}, {floor_at(0)}});
  EXPECT_EQ(reached_from(door, 0, {.height = 18, .step = 4, .jump = 12, .gap = 0}), (std::vector<int>{1, 0, 0}));
  // Two spaces whose heights do not overlap enough: a player does not fit through.
  const open_field window = row_of({{floor_at(0, 30)}, {floor_at(20, 60)}});
  EXPECT_EQ(reached_from(window, 1), (std::vector<int>{0, 1}));
}

TEST(reach, storeys_are_apart) {
  const open_field house = row_of({{floor_at(0, 28), floor_at(30)}, {floor_at(0, 28), floor_at(30)}});
  EXPECT_EQ(reached_from(house, 0), (std::vector<int>{1, 0, 1, 0}));
}

TEST(reach, steep_ground_is_slid_down) {
  const open_field bank = row_of({{floor_at(40)}, {slope_at(30)}, {slope_at(10)}, {floor_at(0)}});
  EXPECT_EQ(reached_from(bank, 0), (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(reached_from(bank, 3), (std::vector<int>{0, 0, 0, 1}));
}

TEST(reach, a_jump_crosses_a_gap) {
  const open_field gap = row_of({{floor_at(50)}, {floor_at(0)}, {floor_at(0)}, {floor_at(50)}});
  EXPECT_EQ(reached_from(gap, 0), (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(reached_from(gap, 0, {.height = 18, .step = 4, .jump = 12, .gap = 2}), (std::vector<int>{1, 1, 1, 0}));
  EXPECT_EQ(reached_from(gap, 1), (std::vector<int>{0, 1, 1, 0})) << "not from the bottom";
  const open_field closed = row_of({{floor_at(50)}, {floor_at(0)}, {floor_at(0, 60)}, {floor_at(50)}});
  EXPECT_EQ(reached_from(closed, 0), (std::vector<int>{1, 1, 1, 0})) << "something hangs in the way";
}

TEST(reach, regions_are_connected_by_steps_alone) {
  const open_field field = row_of({{floor_at(0)}, {floor_at(4)}, {floor_at(12)}, {slope_at(12)}, {floor_at(12)}});
  std::vector<std::uint32_t> sizes;
  const std::vector<std::uint32_t> region_of = find_regions(field, person, sizes);
  EXPECT_EQ(region_of, (std::vector<std::uint32_t>{0, 0, 1, no_region, 2}));
  EXPECT_EQ(sizes, (std::vector<std::uint32_t>{2, 1, 1}));
}

}  // namespace
}  // namespace sightcell::bake
