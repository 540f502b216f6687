#include "cells/reach.h"

#include <algorithm>
#include <utility>

namespace sightcell::bake {
namespace {

// Calls visit with the index of each space of the four columns beside that a player fits through to.
template <typename Visit>
void for_each_beside(const open_field& field, const player_moves& moves, std::size_t column, std::uint32_t space,
                     const Visit& visit) {
  const open_space& from = field.spaces[space];
  const std::size_t x = column % field.width, z = column / field.width;
  const auto look = [&](std::size_t beside) {
    for (std::uint32_t i = field.begins[beside]; i < field.begins[beside + 1]; ++i) {
      const open_space& to = field.spaces[i];
      if (std::min(from.ceiling, to.ceiling) - std::max(from.floor, to.floor) >= moves.height) visit(beside, i);
    }
  };
  if (x > 0) look(column - 1);
  if (x + 1 < field.width) look(column + 1);
  if (z > 0) look(column - field.width);
  if (z + 1 < field.depth) look(column + field.width);
}

bool gets_to(const open_space& from, const open_space& to, const player_moves& moves) {
  const std::int32_t up = to.floor - from.floor;
  if (!to.walkable) return up <= 0;
  return up <= (from.walkable ? moves.jump : moves.step);
}

// Calls land with each space that a jump along a row or column of the field gets to: over the gap the air from the
// floor up to the height of the player is empty, and the landing is walkable and no higher than the start.
template <typename Land>
void jump_over_gaps(const open_field& field, const player_moves& moves, std::size_t column, std::uint32_t space,
                    const Land& land) {
  const open_space& from = field.spaces[space];
  if (!from.walkable || moves.gap < 2) return;
  const auto x = static_cast<std::int64_t>(column % field.width), z = static_cast<std::int64_t>(column / field.width);
  for (const auto& [dx, dz] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    for (std::int64_t k = 1; k <= moves.gap; ++k) {
      const std::int64_t to_x = x + k * dx, to_z = z + k * dz;
      if (to_x < 0 || to_z < 0 || to_x >= static_cast<std::int64_t>(field.width) ||
          to_z >= static_cast<std::int64_t>(field.depth))
        break;
      const std::size_t beside = static_cast<std::size_t>(to_z) * field.width + static_cast<std::size_t>(to_x);
      bool passes = false, lands = false;
      for (std::uint32_t i = field.begins[beside]; i < field.begins[beside + 1]; ++i) {
        const open_space& to = field.spaces[i];
        if (to.floor > from.floor + moves.step || to.ceiling < from.floor + moves.height) continue;
        passes = true;
        if (to.walkable && to.floor >= from.floor - moves.jump) {
          lands = true;
          if (k > 1) land(beside, i);
        }
      }
      if (!passes || lands) break;
    }
}

struct visited {
  std::size_t column = 0;
  std::uint32_t space = 0;
};

}  // namespace

std::vector<std::uint32_t> find_regions(const open_field& field, const player_moves& moves,
                                        std::vector<std::uint32_t>& sizes) {
  std::vector<std::uint32_t> region_of(field.spaces.size(), no_region);
  std::vector<visited> open;
  sizes.clear();
  for (std::size_t column = 0; column + 1 < field.begins.size(); ++column)
    for (std::uint32_t first = field.begins[column]; first < field.begins[column + 1]; ++first) {
      if (region_of[first] != no_region || !field.spaces[first].walkable) continue;
      const auto region = static_cast<std::uint32_t>(sizes.size());
      sizes.push_back(0);
      region_of[first] = region;
      open.assign(1, {column, first});
      while (!open.empty()) {
        const visited at = open.back();
        open.pop_back();
        ++sizes[region];
        for_each_beside(field, moves, at.column, at.space, [&](std::size_t beside, std::uint32_t space) {
          const open_space& to = field.spaces[space];
          if (region_of[space] != no_region || !to.walkable) return;
          if (std::abs(to.floor - field.spaces[at.space].floor) > moves.step) return;
          region_of[space] = region;
          open.push_back({beside, space});
        });
      }
    }
  return region_of;
}

std::vector<std::uint8_t> find_reached(const open_field& field, const player_moves& moves,
                                       std::span<const std::uint32_t> starts) {
  std::vector<std::uint8_t> reached(field.spaces.size(), 0);
  std::vector<visited> open;
  for (const std::uint32_t start : starts) {
    if (reached[start]) continue;
    reached[start] = 1;
    const auto after = std::upper_bound(field.begins.begin(), field.begins.end(), start);
    open.push_back({static_cast<std::size_t>(after - field.begins.begin()) - 1, start});
  }
  while (!open.empty()) {
    const visited at = open.back();
    open.pop_back();
    for_each_beside(field, moves, at.column, at.space, [&](std::size_t beside, std::uint32_t space) {
      if (reached[space] || !gets_to(field.spaces[at.space], field.spaces[space], moves)) return;
      reached[space] = 1;
      open.push_back({beside, space});
    });
    jump_over_gaps(field, moves, at.column, at.space, [&](std::size_t beside, std::uint32_t space) {
      if (reached[space]) return;
      reached[space] = 1;
      open.push_back({beside, space});
    });
  }
  return reached;
}

}  // namespace sightcell::bake
