#pragma once
// Cells in blocks: the unit of work that is shared between cells, and between machines
// (docs/method/determinism-and-sharding.md). A block is an aligned chunk of 8 x 8 lattice cells and all layers of them;
// a box given by hand is a block by itself.
//
// In phase 1 cells of one block see what each other found, and nothing crosses a block's border; phase 2 reads what
// phase 1 found in the blocks around.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

class cell_blocks {
 public:
  // All cells are on one lattice, or none is. margin: by which boxes are grown.
  cell_blocks(std::span<const view_cell> cells, float margin);

  std::uint32_t count() const { return static_cast<std::uint32_t>(begins_.size()) - 1; }
  // Ascending places in the list of cells.
  std::span<const std::uint32_t> cells_of(std::uint32_t block) const {
    return std::span(cells_).subspan(begins_[block], begins_[block + 1] - begins_[block]);
  }
  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(cells_.size()); }
  std::uint32_t block_of(std::uint32_t cell) const { return block_of_[cell]; }
  // For people: "block 3,-1 (x 24 to 32 m, z -8 to 0 m)" or "cell 12 \"lane\"".
  const std::string& name_of(std::uint32_t block) const { return names_[block]; }

  // The cells around on the lattice; of boxes given by hand those whose grown boxes touch this one's, at most
  // neighbor_limit of them. Nearest centers first, then by place: whatever the order of the list.
  std::span<const std::uint32_t> neighbors_of(std::uint32_t cell) const {
    return std::span(neighbors_).subspan(neighbor_begins_[cell], neighbor_begins_[cell + 1] - neighbor_begins_[cell]);
  }
  std::vector<std::uint32_t> neighbors_in_block(std::uint32_t cell) const;  // of these those of its own block

  // As many as a lattice cell has.
  static constexpr std::size_t neighbor_limit = 26;

 private:
  void make_blocks(std::span<const view_cell> cells);
  void find_neighbors(std::span<const view_cell> cells, float margin);

  std::vector<std::uint32_t> cells_, begins_, block_of_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> neighbors_, neighbor_begins_;
};

}  // namespace sightcell::bake
