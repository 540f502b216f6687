#include "cells/cell_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr int block_shift = cell_blocks::highest_level;  // 8 cells of level 0

// Sort key that places the cells of a block next to each other: lattice blocks by z, then x; explicit cells by their
// index in the list.
using block_key = std::tuple<bool, std::int64_t, std::int64_t>;

block_key key_of(const view_cell& cell, std::uint32_t place) {
  if (!cell.on_lattice) return {true, place, 0};
  const int shift = block_shift - cell.position.level;
  return {false, cell.position.z >> shift, cell.position.x >> shift};
}

std::string name_of_block(const view_cell& cell) {
  if (!cell.on_lattice)
    return cell.name.empty() ? fmt::format("cell {}", cell.number)
                             : fmt::format("cell {} \"{}\"", cell.number, cell.name);
  const int shift = block_shift - cell.position.level;
  const std::int64_t x = cell.position.x >> shift, z = cell.position.z >> shift;
  const double width = static_cast<double>(cell.max.x) - static_cast<double>(cell.min.x);
  const double size = width * (1 << shift);
  return fmt::format("block {},{} (x {:g} to {:g} m, z {:g} to {:g} m)", x, z, static_cast<double>(x) * size,
                     static_cast<double>(x + 1) * size, static_cast<double>(z) * size,
                     static_cast<double>(z + 1) * size);
}

float square_of_distance(const view_cell& a, const view_cell& b) {
  const glm::vec3 between = 0.5f * (a.min + a.max) - 0.5f * (b.min + b.max);
  return glm::dot(between, between);
}

using neighbor_lists = std::vector<std::vector<std::uint32_t>>;

// Returns the up to 26 lattice neighbors of each cell, of cells that are all of level 0 and one layer.
neighbor_lists around_on_lattice(std::span<const view_cell> cells) {
  std::vector<std::pair<lattice_position, std::uint32_t>> places;
  for (std::uint32_t i = 0; i < cells.size(); ++i) places.emplace_back(cells[i].position, i);
  std::sort(places.begin(), places.end());
  neighbor_lists found(cells.size());
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    // Cells along x are consecutive in this order.
    const lattice_position& at = cells[i].position;
    for (std::int64_t z = at.z - 1; z <= at.z + 1; ++z)
      for (std::int64_t y = at.y - 1; y <= at.y + 1; ++y) {
        const lattice_position from{.z = z, .y = y, .x = at.x - 1}, to{.z = z, .y = y, .x = at.x + 1};
        for (auto p = std::lower_bound(places.begin(), places.end(), std::pair(from, 0u));
             p != places.end() && p->first <= to; ++p)
          if (p->second != i) found[i].push_back(p->second);
      }
  }
  return found;
}

// Returns the cells whose grown boxes touch that of each cell. Cells are sorted along the axis of their widest spread;
// only those that begin before a cell ends can touch it.
neighbor_lists touching(std::span<const view_cell> cells, float margin) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const view_cell& c : cells) low = glm::min(low, c.min), high = glm::max(high, c.min);
  const glm::vec3 spread = high - low;
  const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.z >= spread.y ? 2 : 1;

  std::vector<std::uint32_t> order(cells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(cells[a].min[axis], a) < std::tuple(cells[b].min[axis], b);
  });
  neighbor_lists found(cells.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const view_cell& one = cells[order[i]];
    const glm::vec3 one_low = one.min - margin, one_high = one.max + margin;
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const view_cell& other = cells[order[k]];
      const glm::vec3 other_low = other.min - margin, other_high = other.max + margin;
      if (other_low[axis] > one_high[axis]) break;
      if (glm::any(glm::greaterThan(other_low, one_high)) || glm::any(glm::lessThan(other_high, one_low))) continue;
      found[order[i]].push_back(order[k]);
      found[order[k]].push_back(order[i]);
    }
  }
  return found;
}

}  // namespace

cell_blocks::cell_blocks(std::span<const view_cell> cells, float margin) {
  make_blocks(cells);
  find_neighbors(cells, margin);
}

void cell_blocks::make_blocks(std::span<const view_cell> cells) {
  cells_.resize(cells.size());
  std::iota(cells_.begin(), cells_.end(), 0u);
  std::stable_sort(cells_.begin(), cells_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key_of(cells[a], a) < key_of(cells[b], b); });
  block_of_.resize(cells.size());
  for (std::uint32_t i = 0; i < cells_.size(); ++i) {
    const std::uint32_t cell = cells_[i];
    if (i == 0 || key_of(cells[cell], cell) != key_of(cells[cells_[i - 1]], cells_[i - 1])) {
      begins_.push_back(i);
      names_.push_back(name_of_block(cells[cell]));
    }
    block_of_[cell] = static_cast<std::uint32_t>(names_.size()) - 1;
  }
  begins_.push_back(static_cast<std::uint32_t>(cells_.size()));
}

void cell_blocks::find_neighbors(std::span<const view_cell> cells, float margin) {
  const bool on_lattice = !cells.empty() && cells.front().on_lattice;  // all cells are, or none
  const bool in_a_grid = on_lattice && std::all_of(cells.begin(), cells.end(), [](const view_cell& c) {
                           return c.position.level == 0 && c.position.layers == 1;
                         });
  std::vector<std::vector<std::uint32_t>> found =
      in_a_grid ? around_on_lattice(cells) : touching(cells, on_lattice ? 0.0f : margin);
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    neighbor_begins_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
    std::vector<std::uint32_t>& near = found[cell];
    std::sort(near.begin(), near.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(square_of_distance(cells[cell], cells[a]), cells[a].place, a) <
             std::tuple(square_of_distance(cells[cell], cells[b]), cells[b].place, b);
    });
    near.resize(std::min(near.size(), neighbor_limit));
    neighbors_.insert(neighbors_.end(), near.begin(), near.end());
  }
  neighbor_begins_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
}

std::vector<std::uint32_t> cell_blocks::neighbors_in_block(std::uint32_t cell) const {
  std::vector<std::uint32_t> own;
  for (const std::uint32_t other : neighbors_of(cell))
    if (block_of_[other] == block_of_[cell]) own.push_back(other);
  return own;
}

}  // namespace sightcell::bake
