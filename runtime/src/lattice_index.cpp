#include "lattice_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sightcell::runtime {
namespace {

constexpr std::int32_t chunk_width = format::lattice_chunk_width;
constexpr double most_places = 1 << 30;  // in either direction from the origin

// Up to here borders are rounded by at most a 16th of a cell, so that a cell of a finer level has the smaller volume.
constexpr std::int32_t nearby_places = 1 << 20;

// At half load, a table of chunks that were not chosen to collide has clusters of a few dozen slots. The probability of
// one of this length is below 10^-40.
constexpr std::uint32_t longest_probe = 1024;

float border(std::int32_t place, double width) noexcept {
  return static_cast<float>(place * width);
}

// A lattice coordinate on one axis and the ends of its cell.
struct axis_place {
  std::int32_t place = 0;
  float low = 0.0f, high = 0.0f;
};

// Finds the lattice coordinate whose cell, with ends rounded to float, contains a position. False: beyond the lattice,
// or NaN.
bool place_on_axis(float coordinate, double width, double per_width, axis_place& out) noexcept {
  const double estimate = static_cast<double>(coordinate) * per_width;
  if (!(estimate >= -most_places && estimate < most_places)) return false;
  auto place = static_cast<std::int32_t>(estimate);
  place -=
      static_cast<std::int32_t>(place > estimate);  // rounds down, without a branch, since signs cannot be predicted
  float low = border(place, width);
  float high = border(place + 1, width);
  // Borders differ from the exact ones by half a step of floats, which is below 64 widths for any coordinate that is
  // numbered: these loops are short, and mostly empty.
  while (coordinate < low) {
    high = low;
    low = border(--place, width);
  }
  while (coordinate >= high) {
    low = high;
    high = border(++place + 1, width);
  }
  out = {place, low, high};
  return true;
}

// The caller checks that the position is in the chunk.
unsigned bit_of(std::int32_t x, std::int32_t z) noexcept {
  return static_cast<unsigned>((z & (chunk_width - 1)) * chunk_width + (x & (chunk_width - 1)));
}

// Rounds down, as shifts of negative numbers do.
std::int32_t chunk_of(std::int32_t place) noexcept {
  return place >> std::countr_zero(static_cast<unsigned>(chunk_width));
}

// Chunks of one axis, both ends included.
struct place_range {
  std::int32_t first = 0, last = -1;
  [[nodiscard]] std::uint64_t count() const noexcept {
    return last < first ? 0 : static_cast<std::uint64_t>(std::int64_t{last} - first) + 1;
  }
};

// The chunks whose cells may have a border between two positions, rounded borders included. A few more are harmless.
// per_chunk: cells of a chunk on this axis.
place_range chunks_between(double low, double high, double per_width, std::int32_t per_chunk) noexcept {
  constexpr double rounding = 1.0 / (1 << 23);  // twice the relative rounding of a border
  constexpr double more = 1e-6;                 // of a cell: rounding of products
  const double most = most_places / per_chunk;
  const auto chunk = [&](double places) {
    double near = places / per_chunk;
    if (!(near < most - 1.0)) near = most - 1.0;  // also for the NaN of infinite ends
    if (near < -most) near = -most;
    const auto whole = static_cast<std::int32_t>(near);
    return whole - static_cast<std::int32_t>(whole > near);  // rounds down
  };
  return {chunk((low - std::abs(low) * rounding) * per_width - more),
          chunk((high + std::abs(high) * rounding) * per_width + more)};
}

}  // namespace

std::uint64_t lattice_index::slot_of(std::int32_t x, std::int32_t y, std::int32_t z,
                                     std::uint32_t level) const noexcept {
  // Two rounds of multiplication and folding: neighbors, which are looked up together, get distant slots.
  std::uint64_t h =
      (std::uint64_t{static_cast<std::uint32_t>(x)} << 32 | static_cast<std::uint32_t>(z)) * 0x9E3779B97F4A7C15u;
  h ^= h >> 32;
  h = (h ^ (std::uint64_t{level} << 32 | static_cast<std::uint32_t>(y))) * 0xD6E8FEB86659FD93u;
  return (h >> 32) * slots_.size() >> 32;
}

const lattice_slot* lattice_index::chunk_at(std::int32_t x, std::int32_t y, std::int32_t z,
                                            std::uint32_t level) const noexcept {
  std::uint64_t at = slot_of(x, y, z, level);
  for (;;) {
    const lattice_slot& slot = slots_[static_cast<std::size_t>(at)];
    if (slot.mask == 0) return nullptr;  // ends: half of all slots are empty
    if (slot.x == x && slot.z == z && slot.y == y && slot.level() == level) return &slot;
    if (++at == slots_.size()) at = 0;
  }
}

bool lattice_index::insert(const lattice_slot& chunk) noexcept {
  std::uint64_t at = slot_of(chunk.x, chunk.y, chunk.z, chunk.level());
  for (std::uint32_t probe = 0; probe < longest_probe; ++probe) {
    lattice_slot& slot = slots_[static_cast<std::size_t>(at)];
    if (slot.mask == 0) {
      slot = chunk;
      return true;
    }
    if (++at == slots_.size()) at = 0;
  }
  return false;
}

bool lattice_index::build(const format::cell_lattice& lattice, std::uint32_t cells,
                          std::span<lattice_slot> slots) noexcept {
  shape_ = lattice.shape();
  slots_ = slots;
  std::uint32_t used_levels = 0;
  std::uint64_t next = 0;
  for (std::uint32_t number = 0; number < lattice.chunk_count(); ++number) {
    const format::lattice_chunk c = lattice.chunk(number);
    if (c.level > format::max_lattice_level || c.first_cell != next || c.mask == 0) return false;
    next += count_bits(c.mask);
    if (next > cells || !insert({c.mask, c.x, c.y, c.z, c.level << 24 | c.first_cell})) return false;
    used_levels |= std::uint32_t{1} << c.level;
    for (const std::int32_t place : {c.x * chunk_width, c.y, c.z * chunk_width}) {
      finer_is_smaller_ = finer_is_smaller_ && place >= -nearby_places && place < nearby_places;
    }
  }
  for (std::uint32_t level = format::max_lattice_level + 1; level-- > 0;) {
    if ((used_levels >> level & 1) == 0) continue;
    const double width = shape_.width_of(level), height = shape_.height_of(level);
    levels_[level_count_++] = {level, width, height, 1.0 / width, 1.0 / height};
  }
  return next == cells;
}

std::uint32_t lattice_index::find(const rounded_point& position, double volume_limit, format::box& out) const noexcept {
  std::uint32_t best = no_cell;
  double best_volume = volume_limit;
  for (const level_shape& level : levels()) {
    axis_place x;
    axis_place y;
    axis_place z;
    if (!place_on_axis(position[0], level.width, level.per_width, x) ||
        !place_on_axis(position[2], level.width, level.per_width, z) ||
        !place_on_axis(position[1], level.height, level.per_height, y)) {
      continue;
    }
    const lattice_slot* chunk = chunk_at(chunk_of(x.place), y.place, chunk_of(z.place), level.level);
    if (chunk == nullptr) continue;
    const unsigned bit = bit_of(x.place, z.place);
    if ((chunk->mask >> bit & 1) == 0) continue;
    const std::uint32_t cell = chunk->first_cell() + count_bits(chunk->mask & ((std::uint64_t{1} << bit) - 1));
    const format::box bounds{{x.low, y.low, z.low}, {x.high, y.high, z.high}};
    if (volume_limit != any_volume || !finer_is_smaller_) {
      const double volume = volume_of(bounds);
      if (!(volume < best_volume || (best != no_cell && volume == best_volume && cell < best))) continue;
      best_volume = volume;
    }
    best = cell;
    out = bounds;
    if (finer_is_smaller_) break;
  }
  return best;
}

// Adds to found. Ends when dst is full.
template <class Test>
std::size_t lattice_index::touching_level(const level_shape& level, const wide_box& within, const Test& test,
                                          std::span<located_cell> dst, std::size_t found) const noexcept {
  const auto take = [&](const lattice_slot& chunk) {
    for (std::uint64_t left = chunk.mask; left != 0 && found <= dst.size(); left &= left - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(left));
      const format::box bounds = box_of(chunk, bit);
      if (!test(widened(bounds))) continue;
      const auto before = count_bits(chunk.mask & ((std::uint64_t{1} << bit) - 1));
      if (found < dst.size()) dst[found] = {bounds, chunk.first_cell() + before};
      ++found;
    }
  };
  const place_range x = chunks_between(within.min[0], within.max[0], level.per_width, chunk_width);
  const place_range y = chunks_between(within.min[1], within.max[1], level.per_height, 1);
  const place_range z = chunks_between(within.min[2], within.max[2], level.per_width, chunk_width);
  // If the range has more chunks than the table, the table is scanned instead.
  if (x.count() * y.count() > slots_.size() || x.count() * y.count() * z.count() > slots_.size()) {
    for (const lattice_slot& slot : slots_) {
      if (slot.mask != 0 && slot.level() == level.level) take(slot);
    }
    return found;
  }
  for (std::int32_t cz = z.first; cz <= z.last; ++cz) {
    for (std::int32_t cx = x.first; cx <= x.last; ++cx) {
      for (std::int32_t cy = y.first; cy <= y.last && found <= dst.size(); ++cy) {
        const lattice_slot* chunk = chunk_at(cx, cy, cz, level.level);
        if (chunk != nullptr) take(*chunk);
      }
    }
  }
  return found;
}

bool lattice_index::has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept {
  if (!finer_is_smaller_) return level_count_ > 1;
  const wide_box inside = widened(bounds);
  for (const level_shape& level : levels()) {
    // The volumes of two levels differ by a factor of 8, of which rounding changes at most a third.
    if (level.width * level.width * level.height > 0.5 * volume_limit) continue;
    if (inside.max[0] - inside.min[0] > chunk_width * level.width) return true;  // too many chunks to search
    const auto reaches_in = [&](const wide_box& cell) { return boxes_meet(cell, inside); };
    if (touching_level(level, inside, reaches_in, {}, 0) > 0) return true;
  }
  return false;
}

std::size_t lattice_index::touching(const wide_box& closed, std::span<located_cell> dst) const noexcept {
  std::size_t found = 0;
  for (const level_shape& level : levels()) {
    found = touching_level(
        level, closed, [&](const wide_box& cell) { return touches(closed, cell); }, dst, found);
    if (found > dst.size()) break;
  }
  return found;
}

void lattice_index::nearest(nearest_search& search) const noexcept {
  for (const lattice_slot& slot : slots_) {
    if (slot.mask == 0 || search.out_of_reach(search.distance_to(bounds_of(slot)))) continue;
    std::uint32_t cell = slot.first_cell();
    for (std::uint64_t left = slot.mask; left != 0; left &= left - 1) {
      search.take(box_of(slot, static_cast<unsigned>(std::countr_zero(left))), cell++);
    }
  }
}

wide_box lattice_index::bounds_of(const lattice_slot& chunk) const noexcept {
  wide_box all = widened(box_of(chunk, 0));
  all.max = widened(box_of(chunk, chunk_width * chunk_width - 1)).max;
  return all;
}

format::box lattice_index::box_of(const lattice_slot& chunk, unsigned bit) const noexcept {
  const format::lattice_chunk as_stored{chunk.x, chunk.y, chunk.z, chunk.level(), 0, chunk.mask};
  return format::box_of(shape_, format::place_of(as_stored, bit));
}

}  // namespace sightcell::runtime
