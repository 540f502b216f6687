// Which cells are in a block, which lie around a cell, and in which order their rounds can be taken.
#include "cells/cell_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cells/lattice.h"
#include "job/cell_steps.h"

namespace sightcell::bake {
namespace {

std::vector<view_cell> lattice_cells(std::int64_t from, std::int64_t to, std::int64_t layers = 1) {
  const lattice on(4.0);
  std::vector<view_cell> cells;
  for (std::int64_t z = from; z < to; ++z)
    for (std::int64_t y = 0; y < layers; ++y)
      for (std::int64_t x = from; x < to; ++x) cells.push_back(on.cell({.z = z, .y = y, .x = x}));
  return cells;
}

TEST(cell_blocks, are_aligned_chunks_of_eight_by_eight_and_all_layers) {
  const auto cells = lattice_cells(-9, 9, 3);
  const cell_blocks blocks(cells, 0.25f);
  EXPECT_EQ(blocks.count(), 16u) << "1 + 8 + 8 + 1 along each axis";
  std::size_t all = 0;
  for (std::uint32_t b = 0; b < blocks.count(); ++b) {
    std::set<std::pair<std::int64_t, std::int64_t>> places;
    for (const std::uint32_t cell : blocks.cells_of(b)) {
      EXPECT_EQ(blocks.block_of(cell), b);
      places.insert({cells[cell].position.x >> 3, cells[cell].position.z >> 3});
    }
    EXPECT_EQ(places.size(), 1u);
    EXPECT_TRUE(std::is_sorted(blocks.cells_of(b).begin(), blocks.cells_of(b).end()));
    all += blocks.cells_of(b).size();
  }
  EXPECT_EQ(all, cells.size());
  EXPECT_EQ(blocks.name_of(0), "block -2,-2 (x -64 to -32 m, z -64 to -32 m)");
}

// A cell of each level: each is in the block that it fills a part of, and cells that touch are neighbors.
TEST(cell_blocks, wider_cells_are_in_the_block_of_what_they_cover) {
  const lattice on(4.0);
  const std::vector<view_cell> cells{on.cell({.z = 0, .x = -1, .level = 3}),
                                     on.cell({.z = 0, .x = 0, .level = 2}),
                                     on.cell({.z = 2, .x = 2, .level = 1}),
                                     on.cell({.z = 7, .x = 7}),
                                     on.cell({.z = 8, .x = 8}),
                                     on.cell({.z = 6, .x = 6, .level = 1})};
  const cell_blocks blocks(cells, 0.25f);
  EXPECT_EQ(blocks.count(), 3u);
  EXPECT_EQ(blocks.block_of(1), blocks.block_of(2));
  EXPECT_EQ(blocks.block_of(1), blocks.block_of(3));
  EXPECT_EQ(blocks.block_of(4), blocks.block_of(5));
  EXPECT_EQ(blocks.name_of(blocks.block_of(0)), "block -1,0 (x -32 to 0 m, z 0 to 32 m)");
  EXPECT_EQ(blocks.name_of(blocks.block_of(1)), "block 0,0 (x 0 to 32 m, z 0 to 32 m)");
  EXPECT_EQ(blocks.name_of(blocks.block_of(4)), "block 1,1 (x 32 to 64 m, z 32 to 64 m)");
  const auto neighbors = [&](std::uint32_t cell) {
    const auto found = blocks.neighbors_of(cell);
    return std::set<std::uint32_t>(found.begin(), found.end());
  };
  EXPECT_EQ(neighbors(0), (std::set<std::uint32_t>{1}));
  EXPECT_EQ(neighbors(1), (std::set<std::uint32_t>{0, 2}));
  EXPECT_EQ(neighbors(2), (std::set<std::uint32_t>{1}));
  EXPECT_EQ(neighbors(3), (std::set<std::uint32_t>{4}));
}

TEST(cell_blocks, neighbors_on_the_lattice_are_the_26_around) {
  const auto cells = lattice_cells(0, 16, 3);
  for (const float margin : {0.0f, 0.25f, 9.0f}) {
    const cell_blocks blocks(cells, margin);
    for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
      std::set<std::uint32_t> expected;
      for (std::uint32_t other = 0; other < cells.size(); ++other) {
        const auto &a = cells[cell].position, &b = cells[other].position;
        if (other != cell && std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && std::abs(a.z - b.z) <= 1)
          expected.insert(other);
      }
      const auto found = blocks.neighbors_of(cell);
      EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()), expected);
      EXPECT_EQ(found.size(), expected.size());
    }
    // The cell at a block's corner has 7 of its own block beside it on the ground, and 26 in the middle of a block.
    EXPECT_EQ(blocks.neighbors_in_block(0).size(), 7u);
    EXPECT_EQ(blocks.neighbors_of(0).size(), 7u);
    const auto middle = static_cast<std::uint32_t>((7 * 3 + 1) * 16 + 7);
    EXPECT_EQ(blocks.neighbors_of(middle).size(), 26u);
    EXPECT_EQ(blocks.neighbors_in_block(middle).size(), 11u);
  }
}

TEST(cell_blocks, boxes_by_hand_are_blocks_and_touch_by_their_grown_boxes) {
  std::vector<view_cell> cells;
  const auto add = [&](glm::vec3 min, glm::vec3 max, const char* name) {
    cells.push_back({min, max, name, 100u + cells.size(), static_cast<std::uint32_t>(cells.size()), false, {}});
  };
  add({0, 0, 0}, {2, 2, 2}, "a");
  add({2.4f, 0, 0}, {4, 2, 2}, "");
  add({10, 0, 0}, {11, 2, 2}, "c");
  add({-5, 0, -5}, {20, 1, 20}, "all");
  const cell_blocks blocks(cells, 0.25f);
  EXPECT_EQ(blocks.count(), 4u);
  EXPECT_EQ(blocks.name_of(0), "cell 0 \"a\"");
  EXPECT_EQ(blocks.name_of(1), "cell 1");
  const auto near = [&](std::uint32_t cell) {
    const auto found = blocks.neighbors_of(cell);
    return std::set<std::uint32_t>(found.begin(), found.end());
  };
  EXPECT_EQ(near(0), (std::set<std::uint32_t>{1, 3}));
  EXPECT_EQ(near(2), (std::set<std::uint32_t>{3}));
  EXPECT_EQ(near(3), (std::set<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(blocks.neighbors_in_block(0).empty());
  const cell_blocks apart(cells, 0.0f);
  EXPECT_EQ(apart.neighbors_of(0).size(), 1u) << "0.4 m from the other";
  for (int i = 0; i < 100; ++i) add({0, 0, 0}, {1, 1, 1 + static_cast<float>(i)}, "");
  EXPECT_EQ(cell_blocks(cells, 0.25f).neighbors_of(3).size(), cell_blocks::neighbor_limit);
}

TEST(step_queue, a_second_round_waits_for_the_first_of_its_block_alone) {
  const auto cells = lattice_cells(0, 16);  // four blocks of 64
  const cell_blocks blocks(cells, 0.25f);
  const stage_plan plan(blocks, true);
  const std::vector<std::uint32_t> order{2, 0, 3, 1};
  stage_table have(cells.size());
  step_queue queue = step_queue::phase_1(plan, have, order);
  EXPECT_EQ(queue.count(), 512u);
  std::vector<cell_step> begun;
  for (int i = 0; i < 64; ++i) begun.push_back(*queue.begin_next());
  for (const cell_step& step : begun) {
    EXPECT_EQ(step.to, cell_stage::sampled);
    EXPECT_EQ(blocks.block_of(step.cell), 2u);
  }
  for (int i = 0; i < 63; ++i) queue.committed(begun[static_cast<std::size_t>(i)]);
  EXPECT_EQ(queue.begin_next()->to, cell_stage::sampled) << "of the next block: one of the first is not committed";
  queue.committed(begun[63]);
  for (int i = 0; i < 64; ++i) {
    const auto step = queue.begin_next();
    EXPECT_EQ(step->to, cell_stage::bounded);
    EXPECT_EQ(blocks.block_of(step->cell), 2u);
  }
  // All the rest, each committed at once.
  std::set<std::pair<std::uint32_t, cell_stage>> seen;
  while (const auto step = queue.begin_next()) {
    EXPECT_TRUE(seen.insert({step->cell, step->to}).second);
    queue.committed(*step);
  }
  EXPECT_EQ(queue.left(), 1u * 64) << "those whose first round was begun above and never committed hold their block up";
}

TEST(step_queue, a_resumed_block_samples_again_what_its_second_round_reads) {
  const auto cells = lattice_cells(0, 8);
  const cell_blocks blocks(cells, 0.25f);
  const stage_plan plan(blocks, true);
  const std::vector<std::uint32_t> order{0};
  stage_table have(cells.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) have.add(cell, cell_stage::bounded);
  EXPECT_EQ(step_queue::phase_1(plan, have, order).count(), 0u);
  have.remove(20, cell_stage::bounded);  // damaged
  EXPECT_EQ(step_queue::phase_1(plan, have, order).count(), 65u) << "first rounds are gone: all again, and the one";
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) have.add(cell, cell_stage::sampled);
  EXPECT_EQ(step_queue::phase_1(plan, have, order).count(), 1u);
  EXPECT_EQ(step_queue::phase_2(plan, have, order).count(), 64u);
}

TEST(step_queue, a_cell_is_checked_when_it_and_its_neighbors_are_through_phase_1) {
  const auto cells = lattice_cells(0, 16);  // four blocks of 64
  const cell_blocks blocks(cells, 0.25f);
  const stage_plan plan(blocks, true);
  const std::vector<std::uint32_t> order{2, 0, 3, 1};
  stage_table have(cells.size());
  step_queue queue = step_queue::both_phases(plan, have, order);
  EXPECT_EQ(queue.count(), 3u * 256);
  std::size_t checked_before_the_last_block = 0, steps = 0;
  bool last_block = false;
  while (const auto step = queue.begin_next()) {
    ++steps;
    if (step->to == cell_stage::finished) {
      EXPECT_TRUE(have.has(step->cell, cell_stage::bounded));
      for (const std::uint32_t other : blocks.neighbors_of(step->cell))
        EXPECT_TRUE(have.has(other, cell_stage::bounded)) << other << " beside " << step->cell;
      if (!last_block) ++checked_before_the_last_block;
    }
    last_block |= blocks.block_of(step->cell) == order.back();
    EXPECT_FALSE(have.has(step->cell, step->to));
    have.add(step->cell, step->to);
    queue.committed(*step);
  }
  EXPECT_EQ(steps, queue.count());
  EXPECT_EQ(queue.left(), 0u);
  // The last block is a quarter of the square; the cells along its border wait for it: 8 on each side, and the corner.
  EXPECT_EQ(checked_before_the_last_block, 3u * 64 - 17);
}

TEST(step_queue, a_resumed_bake_checks_what_is_not_checked) {
  const auto cells = lattice_cells(0, 16);
  const cell_blocks blocks(cells, 0.25f);
  const stage_plan plan(blocks, true);
  const std::vector<std::uint32_t> order{0, 1, 2, 3};
  stage_table have(cells.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    have.add(cell, cell_stage::sampled);
    have.add(cell, cell_stage::bounded);
    if (cell % 2 == 0) have.add(cell, cell_stage::finished);
  }
  EXPECT_EQ(step_queue::both_phases(plan, have, order).count(), 128u);
  const std::uint32_t damaged = blocks.neighbors_of(1).front();
  have.remove(damaged, cell_stage::bounded);
  step_queue queue = step_queue::both_phases(plan, have, order);
  std::vector<cell_step> begun;
  while (const auto step = queue.begin_next()) begun.push_back(*step);
  ASSERT_FALSE(begun.empty());
  EXPECT_EQ(begun.back(), (cell_step{damaged, cell_stage::bounded})) << "checks that can begin go before phase 1";
  for (const cell_step& step : begun) EXPECT_NE(step.cell, 1u) << "its neighbor is not through phase 1 again";
  EXPECT_GT(queue.left(), 0u);
}

TEST(step_queue, cells_alone_are_one_step) {
  auto cells = lattice_cells(0, 1);
  cells.push_back(lattice(4.0).cell({.z = 40, .y = 0, .x = 40}));
  const cell_blocks blocks(cells, 0.25f);
  const std::vector<std::uint32_t> order{0, 1};
  for (const bool share : {true, false}) {
    const stage_plan plan(blocks, share);
    step_queue queue = step_queue::phase_1(plan, stage_table(2), order);
    EXPECT_EQ(queue.count(), 2u);
    EXPECT_EQ(step_queue::both_phases(plan, stage_table(2), order).count(), 2u) << "no check";
    EXPECT_EQ(queue.begin_next(), (cell_step{0, cell_stage::finished}));
  }
  // Side by side over a block's border: nothing is shared in phase 1, and phase 2 has the last word.
  const lattice on(4.0);
  const std::vector<view_cell> border{on.cell({.z = 0, .y = 0, .x = 7}), on.cell({.z = 0, .y = 0, .x = 8})};
  const cell_blocks two(border, 0.25f);
  const stage_plan plan(two, true);
  step_queue queue = step_queue::phase_1(plan, stage_table(2), order);
  EXPECT_EQ(queue.count(), 2u);
  EXPECT_EQ(queue.begin_next(), (cell_step{0, cell_stage::bounded}));
}

}  // namespace
}  // namespace sightcell::bake
