#pragma once
// The result of a cell so far, and its encoding in a checkpoint.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace sightcell::bake {

// The progress of a cell. Cells with neighbors (cell_blocks.h) are committed at each of these stages, others at the
// last alone.
enum class cell_stage : std::uint8_t {
  sampled = 0,  // phase 1, round 0: sampled by itself
  bounded = 1,  // phase 1, round 1: checked against the cells of its block; verification rays bound what is missing
  finished = 2  // phase 2: checked against the cells of the blocks around; overrides and levels of detail are applied
};

// What found a polygon of a set first. A report shows how much of the sets each finds.
enum class found_by : std::uint8_t {
  sampler,          // hemicubes of the sampler, or its rays
  touching,         // it touches the cell; draws that are in all sets
  adjacent_cell,    // a ray toward what an adjacent cell sees
  later_hemicubes,  // of the search for the bound
  nearby_rays,      // a ray toward a neighbor of a visible polygon
  verification,     // a verification ray, which was a miss until then
  report            // a miss that a host reported
};
inline constexpr std::size_t found_by_count = 7;
using find_counts = std::array<std::uint32_t, found_by_count>;  // polygons, by found_by

// How a set grows with the hemicubes of its cell: step i counts the polygons that hemicubes found first, from number
// 2^(i-1) + 1 to number 2^i of the cell (step 0: the first one). The last step has no end.
inline constexpr std::size_t growth_steps = 14;
using growth_counts = std::array<std::uint32_t, growth_steps>;

// Names the verification rays of a bound, so that they can be cast again after an edit of the scene.
struct bound_rays {
  std::uint32_t number = 0;          // of their batch, which decides its share of the confidence; 0: not known
  std::uint32_t name = 0;            // of their random numbers
  std::vector<std::uint64_t> parts;  // rays of each part of the batch
  bool operator==(const bound_rays&) const = default;
};

struct cell_record {
  std::vector<std::uint32_t> set;      // ascending source ids
  std::vector<std::uint32_t> volumes;  // ascending; empty if the bake has no volumes
  bool stored = true;                  // false: no valid viewpoint was found, and the file leaves the cell out
  bool geometry_inside = false;
  find_counts found{};     // the polygons of the set but for those that join without a test
  growth_counts growth{};  // of these, the polygons that hemicubes found
  std::uint64_t rays = 0;  // certificate: trials of the last batch of verification rays
  std::uint64_t misses = 0;
  double upper_bound = 1.0;
  double confidence = 0.0;
  bound_rays of_bound;
  std::uint32_t batches = 0;  // batches of verification rays so far: the next one has a smaller share of the confidence
  std::uint64_t rays_spent = 0;  // cost of all ray work, in rays
  std::uint32_t samples = 0;     // number of hemicubes rendered
  bool bound_met = true;
  // With settings::seconds_per_cell: the seconds that the stages took; the limit of the next stage follows from it.
  double seconds = 0.0;
  bool out_of_time = false;      // that limit ended the search before the bound was met
  std::uint64_t unverified = 0;  // polygons of a finished cell that joined by conservative dilation

  // The part of the grown box in which viewpoints are drawn (viewpoint_region::encode()); empty: all of it.
  std::vector<std::uint8_t> region;
  double valid_share = 1.0;    // estimated share of the region that is valid
  double outside_share = 0.0;  // upper limit (95 %) of the share of the valid viewpoints that are outside the region
  // Valid viewpoints of the cell itself, as the file has them (format::eye_steps).
  std::vector<std::array<std::uint16_t, 3>> eyes;

  // For the next stages; a finished cell has none of the following.
  // The witnesses of the set: witness_of[i] is the index into witnesses of the viewpoint from which set[i] was found
  // visible.
  std::vector<glm::vec3> witnesses;
  std::vector<std::uint32_t> witness_of;
  // Of a bounded record: the polygons of the set that joined after its cell was sampled, ascending. The neighbors in
  // the block have tested the others.
  std::vector<std::uint32_t> late;
  bool operator==(const cell_record&) const = default;
};

// The part of a record that is summed over cells. It can be read without decoding the set.
struct cell_summary {
  bool stored = true, geometry_inside = false, bound_met = true;
  std::uint64_t rays = 0, misses = 0;
  double upper_bound = 1.0;
  std::uint64_t polygons = 0;  // number of polygons in the set
};
cell_summary summary_of(const cell_record& record);

// Of the encoding. It is in the keys of checkpoints and of kept records, so that those of another version are rejected.
inline constexpr std::uint8_t record_version = 10;

// Returns the bytes of a record: version, the plain fields in little-endian order, the set, its witnesses, the late
// polygons, the volumes if there are any, as varint runs, the rays of the bound, and XXH3-64 of all bytes before it. A
// set takes at most one to two bytes per polygon, its witnesses a few bits per polygon. Two records are equal if their
// bytes are.
std::vector<std::uint8_t> encode(const cell_record& record);
// Decodes a record. Returns nothing if the checksum or anything else is wrong. The bytes may be arbitrary.
std::optional<cell_record> decode(std::span<const std::uint8_t> bytes);
// Decodes the summary of a record. The checksum over all bytes is verified.
std::optional<cell_summary> decode_summary(std::span<const std::uint8_t> bytes);

}  // namespace sightcell::bake
