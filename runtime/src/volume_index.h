#pragma once
// Box -> volumes of the file that it touches, and whether one of them can be seen. Volumes are boxes on a lattice; they
// are grouped in chunks of 4 x 4 x 4 places, a bit each, which a hash table finds. Built once; nothing here allocates.
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

// 4 x 4 x 4 places, or none. Bit x + 4 z + 16 y of places (each mod 4): there is a volume.
struct volume_chunk {
  static constexpr std::int32_t nowhere = std::numeric_limits<std::int32_t>::min();
  std::int32_t x = nowhere, y = 0, z = 0;  // its first place is at 4 times that
  std::uint32_t number = 0;                // which word of a view is the chunk's
  std::uint64_t places = 0;

  [[nodiscard]] bool is_free() const noexcept { return x == nowhere; }
  [[nodiscard]] bool is_at(std::int32_t at_x, std::int32_t at_y, std::int32_t at_z) const noexcept {
    return ((x ^ at_x) | (y ^ at_y) | (z ^ at_z)) == 0;
  }
};

class volume_index {
 public:
  // Looks how much memory the volumes need; carve and build go by that, whatever becomes of the bytes. O(volumes).
  void measure(const format::volume_table& volumes) noexcept;
  // Takes it: about 4 bytes per volume and 50 to 100 per chunk. It stays the caller's and must outlive the index.
  void carve(carver& space) noexcept;
  // False when the bytes changed since they were measured; the index has no volumes then. Where volumes are at one
  // place, that can be seen when one of them can. O(volumes).
  [[nodiscard]] bool build(const format::volume_table& volumes) noexcept;

  // Words of what a view can see.
  [[nodiscard]] std::uint32_t chunk_count() const noexcept { return chunks_; }

  // Makes visible (chunk_count() words) the volumes in runs, by their own numbers, and no others. O(words + volumes).
  void show(std::span<const format::run> volumes, std::span<std::uint64_t> visible) const noexcept;

  // Of one volume, by its number.
  [[nodiscard]] bool is_visible(std::uint32_t volume, std::span<const std::uint64_t> visible) const noexcept {
    const std::uint32_t place = volume < places_.size() ? places_[volume] : no_place;
    return place != no_place && (visible[place / 64] >> place % 64 & 1) != 0;
  }

  // A box that can be asked for: no NaN, min <= max. It may be a point, and infinite.
  [[nodiscard]] static bool is_box(const float min[3], const float max[3]) noexcept {
    return min[0] <= max[0] && min[1] <= max[1] && min[2] <= max[2];
  }

  // False when nothing in the box can be seen: all places that it touches are volumes, and none is visible. The box is
  // closed, and so are places, which begin and end where the boxes of volumes do: on a border it touches both. True for
  // what is no box (is_box). O(places of volumes touched / 64): ends at the first one that may be seen or is no volume.
  [[nodiscard]] bool box_visible(const float min[3], const float max[3],
                                 std::span<const std::uint64_t> visible) const noexcept;

 private:
  // x, y, z, and z again, so that compilers take them together.
  static constexpr std::size_t lanes = 4;
  using lane_floats = std::array<float, lanes>;
  using lane_places = std::array<std::int32_t, lanes>;
  // Places of all axes.
  struct lattice_axes {
    lattice_axes() noexcept = default;
    lattice_axes(double width, double height) noexcept;
    // The last place that begins at or before a number; or one before that, where one of these two has no box and so is
    // no volume. |at| <= reach.
    void last_begun(const lane_floats& at, lane_places& out) const noexcept;

    std::array<double, lanes> size{}, inverse{};  // metres, and places per metre
    lane_floats reach{};                          // metres from the origin: beyond are no volumes
  };
  // first .. last of each axis.
  struct touched_places {
    lane_places first, last;
  };

  // Chunks that are looked at for one before it counts as none: so many only collisions made on purpose need.
  static constexpr std::uint32_t longest_probe = 256;
  static constexpr std::uint32_t no_place = 0xFFFFFFFFu;

  [[nodiscard]] std::uint32_t first_slot(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept;
  // The chunk, or one without places.
  [[nodiscard]] const volume_chunk& find(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept;
  // Null where it would not be found.
  [[nodiscard]] volume_chunk* find_or_add(std::int32_t x, std::int32_t y, std::int32_t z) noexcept;
  // False when the box reaches beyond all volumes, or is none.
  [[nodiscard]] bool touched(const float min[3], const float max[3], touched_places& out) const noexcept;
  [[nodiscard]] bool several_visible(const touched_places& box, std::span<const std::uint64_t> visible) const noexcept;

  std::uint32_t volumes_ = 0;
  std::uint32_t slot_bits_ = 0;
  std::uint32_t chunks_ = 0;
  lattice_axes axes_;
  std::span<volume_chunk> slots_;    // a power of two; chunks lie at the first free one from where their hash says
  std::span<std::uint32_t> places_;  // of each volume: 64 times its chunk, and its bit; or no_place
};

}  // namespace sightcell::runtime
