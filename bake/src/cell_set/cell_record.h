#pragma once
// What a cell has come to, and its bytes in a checkpoint.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace sightcell::bake {

// How far a cell has come. Cells that share (cell_blocks.h) are committed at each of these, others at the last alone.
enum class cell_stage : std::uint8_t {
  sampled = 0,  // phase 1, round 0: what it found by itself
  bounded = 1,  // phase 1, round 1: what its block found was tried, fresh rays bound what is left
  finished = 2  // phase 2: what cells of all blocks around found was tried; with overrides and levels of detail
};

struct cell_record {
  std::vector<std::uint32_t> set;      // ascending source ids
  std::vector<std::uint32_t> volumes;  // ascending; none where the bake has none
  bool stored = true;                  // false: no free point was found, the cell is left out of the file
  bool geometry_inside = false;
  std::uint64_t rays = 0;  // certificate: of the last fresh batch
  std::uint64_t misses = 0;
  double upper_bound = 1.0;
  double confidence = 0.0;
  std::uint32_t batches = 0;     // fresh batches so far: the next one has a smaller share of the confidence
  std::uint64_t rays_spent = 0;  // of all ray work
  std::uint32_t samples = 0;     // hemicubes rendered
  bool bound_met = true;
  std::uint64_t unseen = 0;  // of the set of a finished cell: joined with the safety ring

  // For what comes after; a finished cell has none of it.
  double valid_share = 1.0;  // about this share of the grown box is free
  // Where polygons were seen from: witness_of[i] is the place in witnesses of the eye that saw set[i].
  std::vector<glm::vec3> witnesses;
  std::vector<std::uint32_t> witness_of;
  bool operator==(const cell_record&) const = default;
};

// What is counted over cells, read without their sets.
struct cell_summary {
  bool stored = true, geometry_inside = false, bound_met = true;
  std::uint64_t rays = 0, misses = 0;
  double upper_bound = 1.0;
  std::uint64_t polygons = 0;  // in the set
};
cell_summary summary_of(const cell_record& record);

// Bytes: version, the plain fields little-endian, the set, its witnesses and, where there are any, the volumes as
// varint runs, XXH3-64 of all before it. A set takes one to two bytes per polygon or less, its witnesses a few bits;
// two records are equal where their bytes are.
std::vector<std::uint8_t> encode(const cell_record& record);
// Nothing where the checksum or anything else is wrong: whatever the bytes are.
std::optional<cell_record> decode(std::span<const std::uint8_t> bytes);
// Checks the checksum over all of it.
std::optional<cell_summary> decode_summary(std::span<const std::uint8_t> bytes);

}  // namespace sightcell::bake
