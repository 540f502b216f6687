#pragma once
// Finds the volumes that a box touches, and whether one of them is visible. Volumes are boxes on a lattice. A hash
// table has them in chunks of 4 x 4 x 4 positions, a bit each. Built once; nothing here allocates.
//
//   index.measure(file.volumes());
//   index.carve(space);                           // memory.h: once to count, once to place
//   if (!index.build(file.volumes())) return;     // the bytes changed
//   index.show(row.volumes, visible);             // visible: index.chunk_count() words, of one view
//   bool seen = index.box_visible(min, max, visible);
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "memory.h"
#include "sightcell/format/records.h"
#include "sightcell/format/volume_table.h"

namespace sightcell::runtime {

// A chunk of 4 x 4 x 4 positions, or an empty slot. Bit x + 4 z + 16 y of places (each mod 4): there is a volume.
struct volume_chunk {
  static constexpr std::int32_t nowhere = std::numeric_limits<std::int32_t>::min();
  std::int32_t x = nowhere, y = 0, z = 0;  // its first position is at 4 times this
  std::uint32_t number = 0;                // index of its word in a view
  std::uint64_t places = 0;

  [[nodiscard]] bool is_free() const noexcept { return x == nowhere; }
  [[nodiscard]] bool is_at(std::int32_t at_x, std::int32_t at_y, std::int32_t at_z) const noexcept {
    return ((x ^ at_x) | (y ^ at_y) | (z ^ at_z)) == 0;
  }
};

class volume_index {
 public:
  // Computes the memory that the volumes need. carve and build use this result, also if the bytes change. O(volumes).
  void measure(const format::volume_table& volumes) noexcept;
  // Takes about 4 bytes per volume and 50 to 100 per chunk. The memory belongs to the caller and must outlive the
  // index.
  void carve(carver& space) noexcept;
  // False if the bytes changed since they were measured; the index is empty then. Of several volumes at one position,
  // one visible one makes the position visible. O(volumes).
  [[nodiscard]] bool build(const format::volume_table& volumes) noexcept;

  // Words of the visible volumes of a view.
  [[nodiscard]] std::uint32_t chunk_count() const noexcept { return chunks_; }

  // Sets visible (chunk_count() words) to the volumes in runs, by their own numbers. O(words + volumes).
  void show(std::span<const format::run> volumes, std::span<std::uint64_t> visible) const noexcept;

  // volume: its number.
  [[nodiscard]] bool is_visible(std::uint32_t volume, std::span<const std::uint64_t> visible) const noexcept {
    const std::uint32_t place = volume < places_.size() ? places_[volume] : no_place;
    return place != no_place && (visible[place / 64] >> place % 64 & 1) != 0;
  }

  // A valid box: no NaN, min <= max. It may be a point, and infinite.
  [[nodiscard]] static bool is_box(const float min[3], const float max[3]) noexcept {
    return min[0] <= max[0] && min[1] <= max[1] && min[2] <= max[2];
  }

  // False if all positions that the box touches are volumes and none of these is visible. The box and the positions are
  // closed: on a border the box touches both. True if min and max are not a box (is_box). O(positions of volumes
  // touched / 64): ends at the first one that is visible or is no volume.
  [[nodiscard]] bool box_visible(const float min[3], const float max[3],
                                 std::span<const std::uint64_t> visible) const noexcept;

 private:
  // x, y, z, and z again, so that compilers use SIMD instructions.
  static constexpr std::size_t lanes = 4;
  using lane_floats = std::array<float, lanes>;
  using lane_places = std::array<std::int32_t, lanes>;
  // Sizes of the lattice on all axes.
  struct lattice_axes {
    lattice_axes() noexcept = default;
    lattice_axes(double width, double height) noexcept;
    // The last position that begins at or before a coordinate; or the one before, where one of these two has no box and
    // so is no volume. |at| <= reach.
    void last_begun(const lane_floats& at, lane_places& out) const noexcept;

    std::array<double, lanes> size{}, inverse{};  // meters, and positions per meter
    lane_floats reach{};                          // meters from the origin: there are no volumes beyond
  };
  // first .. last on each axis.
  struct touched_places {
    lane_places first, last;
  };

  // A search ends after this number of slots. Only chunks that were chosen to collide need more.
  static constexpr std::uint32_t longest_probe = 256;
  static constexpr std::uint32_t no_place = 0xFFFFFFFFu;

  [[nodiscard]] std::uint32_t first_slot(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept;
  // The chunk, or one without volumes.
  [[nodiscard]] const volume_chunk& find(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept;
  // Null if find would not find it.
  [[nodiscard]] volume_chunk* find_or_add(std::int32_t x, std::int32_t y, std::int32_t z) noexcept;
  // False if the box reaches beyond all volumes, or is not a box.
  [[nodiscard]] bool touched(const float min[3], const float max[3], touched_places& out) const noexcept;
  [[nodiscard]] bool several_visible(const touched_places& box, std::span<const std::uint64_t> visible) const noexcept;

  std::uint32_t volumes_ = 0;
  std::uint32_t slot_bits_ = 0;
  std::uint32_t chunks_ = 0;
  lattice_axes axes_;
  std::span<volume_chunk> slots_;    // a power of two; a chunk is in the first free slot from its hash on
  std::span<std::uint32_t> places_;  // of each volume: 64 times its chunk, plus its bit; or no_place
};

}  // namespace sightcell::runtime
