#pragma once
// Which floors a player can reach: a flood over the open spaces of a voxel field.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::bake {

// An open space above one voxel: from its floor to what is above it. Heights are in voxels from the bottom of the
// field.
struct open_space {
  std::int32_t floor = 0, ceiling = 0;
  bool walkable = false;  // the floor is flat enough to stand on; else a player slides down
  bool operator==(const open_space&) const = default;
};

// The open spaces of all columns of a field that are high enough for a player. Columns are in rows along x.
struct open_field {
  std::size_t width = 0, depth = 0;   // columns along x and z
  std::vector<std::uint32_t> begins;  // by column, and one past the last: the index of its first space
  std::vector<open_space> spaces;     // of a column from the lowest up

  std::span<const open_space> of(std::size_t column) const {
    return std::span(spaces).subspan(begins[column], begins[column + 1] - begins[column]);
  }
};

// How a player moves, in voxels.
struct player_moves {
  std::int32_t height = 1;  // that must be empty
  std::int32_t step = 0;    // up without a jump
  std::int32_t jump = 0;    // up with one
  std::int32_t gap = 0;     // columns that a jump crosses
};

// Returns for each space the number of its region, from 0: spaces with walkable floors that are connected by steps, in
// both directions. Others have no_region.
// sizes: receives the number of spaces of each region.
inline constexpr std::uint32_t no_region = 0xFFFFFFFFu;
std::vector<std::uint32_t> find_regions(const open_field& field, const player_moves& moves,
                                        std::vector<std::uint32_t>& sizes);

// Returns for each space whether a player gets there from any of the starts: by steps, by jumps up and over gaps, by
// falls of any height, and by sliding down slopes that are too steep to stand on.
// starts: indices of spaces.
std::vector<std::uint8_t> find_reached(const open_field& field, const player_moves& moves,
                                       std::span<const std::uint32_t> starts);

}  // namespace sightcell::bake
