#pragma once
// Blocks of cells: the unit of work that is shared between cells and between machines
// (docs/method/determinism-and-sharding.md). A block is an aligned chunk of 8 x 8 lattice cells of level 0 with all
// cells above them; wider cells fill a part of it. An explicit cell is a block by itself.
//
// In phase 1 a cell uses what the other cells of its block found, and nothing crosses the border of a block. Phase 2
// reads what phase 1 found in the adjacent blocks.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

class cell_blocks {
 public:
  // cells: all on one lattice, or all explicit.
  // margin: distance in meters by which boxes are grown.
  cell_blocks(std::span<const view_cell> cells, float margin);

  std::uint32_t count() const { return static_cast<std::uint32_t>(begins_.size()) - 1; }
  // Returns the cells of a block, as ascending indices into the list of cells.
  std::span<const std::uint32_t> cells_of(std::uint32_t block) const {
    return std::span(cells_).subspan(begins_[block], begins_[block + 1] - begins_[block]);
  }
  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(cells_.size()); }
  std::uint32_t block_of(std::uint32_t cell) const { return block_of_[cell]; }
  // Returns the name of a block for messages: "block 3,-1 (x 24 to 32 m, z -8 to 0 m)" or "cell 12 \"lane\"".
  const std::string& name_of(std::uint32_t block) const { return names_[block]; }

  // The highest level of a lattice cell: it fills a block.
  static constexpr std::int32_t highest_level = 3;

  // Returns the neighbors of a cell, at most neighbor_limit. Those of a lattice cell are the 26 cells around it; where
  // cells have several levels, those that touch it. Those of an explicit cell are the cells whose grown boxes touch its
  // own. Nearest centers come first, then lower values of
  // view_cell::place, so that the order of the list does not matter.
  std::span<const std::uint32_t> neighbors_of(std::uint32_t cell) const {
    return std::span(neighbors_).subspan(neighbor_begins_[cell], neighbor_begins_[cell + 1] - neighbor_begins_[cell]);
  }
  // Returns the neighbors that are in the cell's own block.
  std::vector<std::uint32_t> neighbors_in_block(std::uint32_t cell) const;

  // The number of neighbors of a lattice cell.
  static constexpr std::size_t neighbor_limit = 26;

 private:
  void make_blocks(std::span<const view_cell> cells);
  void find_neighbors(std::span<const view_cell> cells, float margin);

  std::vector<std::uint32_t> cells_, begins_, block_of_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> neighbors_, neighbor_begins_;
};

}  // namespace sightcell::bake
