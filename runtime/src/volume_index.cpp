#include "volume_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

namespace sightcell::runtime {
namespace {

constexpr std::int32_t chunk_width = 4;

// So many places from the origin, a float is off by a fourth of a place at most.
constexpr double near_places = 0x1p22;
// What is found where there is no chunk.
constexpr volume_chunk free_chunk;

// Beyond all places that volumes have.
constexpr std::int64_t far_place = std::int64_t{1} << 31;
constexpr std::int64_t place_limit = std::int64_t{1} << 30;

std::int32_t chunk_of(std::int32_t place) noexcept {
  return place >> 2;  // rounds down, also below 0
}
static_assert(chunk_width == 4);

unsigned bit_of(const format::lattice_place& p) noexcept {
  return static_cast<unsigned>((p.x & 3) + 4 * (p.z & 3) + 16 * (p.y & 3));
}

// Neighbors lie far apart.
std::uint64_t hash_of(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
  const auto wide = [](std::int32_t value) { return std::uint64_t{static_cast<std::uint32_t>(value)}; };
  const std::uint64_t sum =
      wide(x) * 0x9E3779B97F4A7C15u + wide(y) * 0xC2B2AE3D27D4EB4Fu + wide(z) * 0x165667B19E3779F9u;
  return (sum ^ sum >> 32) * 0xD6E8FEB86659FD93u;
}

// Below |value| < 2^62. floor() is a call where processors are not known to have it.
std::int64_t round_down(double value) noexcept {
  const auto toward_zero = static_cast<std::int64_t>(value);
  return toward_zero - (static_cast<double>(toward_zero) > value ? 1 : 0);
}

// Of a finite number; +infinity behind the last one.
float next_float(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);  // -0 becomes 0
  return std::bit_cast<float>(bits >> 31 != 0 ? bits - 1 : bits + 1);
}

// Of four bits, each `stride` behind the one before, those from `from` on: one, and `more`.
std::uint64_t range_bits(std::int32_t more, std::int32_t from, std::uint64_t four_bits, std::int32_t stride) noexcept {
  return four_bits >> (stride * (chunk_width - 1 - more)) << (stride * from);
}

}  // namespace

// A float is off by half of what its last bit counts at most: 2^-24 of it, or 2^-150 around 0. So among near places,
// and where these are not as small as floats get, a border lies less than half a place from where it belongs: the
// number that is asked for is the one that the division gives, rounded down, or the next. Where in a place a box ends
// no processor can foresee: there are no jumps.
inline std::int32_t volume_index::axis_lattice::last_begun(float at) const noexcept {
  const auto toward_zero = static_cast<std::int32_t>(static_cast<double>(at) * inverse);
  const std::int32_t next = toward_zero + static_cast<std::int32_t>(at >= 0.0f);
  return next - static_cast<std::int32_t>(static_cast<float>(next * size) > at);
}

volume_index::axis_lattice::axis_lattice(double metres) noexcept
    : size(metres),
      inverse(1.0 / metres),
      near(metres < 0x1p-126 ? 0.0f : static_cast<float>(std::min(metres * near_places, 0x1p127))) {}

// A border is the float next to its product: at or before a number if that is not beyond the middle between this and
// the next float, where the even one of the two is nearer.
std::int64_t volume_index::axis_lattice::last_begun_far_away(float at) const noexcept {
  if (std::isinf(at)) return at < 0.0f ? -far_place : far_place;
  const float next = next_float(at);
  const double above = std::isinf(next) ? 0x1p128 : static_cast<double>(next);
  const double middle = static_cast<double>(at) / 2 + above / 2;
  const bool even = std::bit_cast<std::uint32_t>(at) % 2 == 0;
  const auto is_begun = [&](std::int64_t place) {
    const double begin = static_cast<double>(place) * size;
    return even ? begin <= middle : begin < middle;
  };
  const double guess = middle * inverse;
  if (!(std::fabs(guess) < static_cast<double>(far_place))) return guess < 0.0 ? -far_place : far_place;
  const std::int64_t place = round_down(guess);  // or one beside it
  if (is_begun(place + 1)) return place + 1;
  return is_begun(place) ? place : place - 1;
}

// How many chunks there are is known when they are found; but volumes of a chunk mostly follow each other, or those of
// some neighboring ones in turn.
void volume_index::measure(const format::volume_table& volumes) noexcept {
  *this = volume_index{};
  std::array<volume_chunk, 256> met{};
  std::uint64_t most = 0;  // or fewer
  format::lattice_place p;
  for (std::uint32_t volume = 0; volume < volumes.count(); ++volume) {
    if (!volumes.place(volume, p)) continue;  // build will say so
    const std::int32_t x = chunk_of(p.x), y = chunk_of(p.y), z = chunk_of(p.z);
    volume_chunk& last = met[hash_of(x, y, z) >> 56];
    if (last.is_at(x, y, z)) continue;
    last = {x, y, z, 0, 0};
    ++most;
  }
  volumes_ = volumes.count();
  slot_bits_ = static_cast<std::uint32_t>(std::bit_width(2 * std::max<std::uint64_t>(most, 1) - 1));
}

void volume_index::carve(carver& space) noexcept {
  const std::size_t slots = volumes_ == 0 ? 0 : std::size_t{1} << slot_bits_;
  auto* first_slot = space.take<volume_chunk>(slots);
  auto* first_place = space.take<std::uint32_t>(volumes_);
  if (first_slot == nullptr || volumes_ == 0) return;
  std::uninitialized_value_construct_n(first_slot, slots);
  std::uninitialized_value_construct_n(first_place, volumes_);
  slots_ = {first_slot, slots};
  places_ = {first_place, volumes_};
}

bool volume_index::build(const format::volume_table& volumes) noexcept {
  axes_ = {axis_lattice(volumes.shape().width), axis_lattice(volumes.shape().height),
           axis_lattice(volumes.shape().width)};
  for (std::uint32_t volume = 0; volume < places_.size(); ++volume) {
    format::lattice_place p;
    if (!volumes.place(volume, p)) {
      slots_ = {};
      places_ = {};
      chunks_ = 0;
      return false;
    }
    volume_chunk* chunk = find_or_add(chunk_of(p.x), chunk_of(p.y), chunk_of(p.z));
    places_[volume] = chunk == nullptr ? no_place : 64 * chunk->number + bit_of(p);
    if (chunk != nullptr) chunk->places |= std::uint64_t{1} << bit_of(p);
  }
  return true;
}

std::uint32_t volume_index::first_slot(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
  return static_cast<std::uint32_t>(hash_of(x, y, z) >> (64 - slot_bits_));
}

inline const volume_chunk& volume_index::find(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
  std::size_t at = first_slot(x, y, z);
  for (std::uint32_t probe = 0; probe < longest_probe; ++probe, at = (at + 1) & (slots_.size() - 1)) {
    const volume_chunk& c = slots_[at];
    if (c.is_at(x, y, z) || c.is_free()) return c;
  }
  return free_chunk;
}

volume_chunk* volume_index::find_or_add(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = first_slot(x, y, z);
  for (std::uint32_t probe = 0; probe < longest_probe; ++probe, at = (at + 1) & mask) {
    volume_chunk& c = slots_[at];
    if (c.is_free()) c = {x, y, z, chunks_++, 0};
    if (c.is_at(x, y, z)) return &c;
  }
  return nullptr;
}

void volume_index::show(std::span<const format::run> volumes, std::span<std::uint64_t> visible) const noexcept {
  std::fill(visible.begin(), visible.end(), std::uint64_t{0});
  for (const format::run& r : volumes) {
    const std::uint64_t end = std::min<std::uint64_t>(std::uint64_t{r.first} + r.count, places_.size());
    for (std::uint64_t volume = r.first; volume < end; ++volume) {
      const std::uint32_t place = places_[static_cast<std::size_t>(volume)];
      if (place / 64 < visible.size()) visible[place / 64] |= std::uint64_t{1} << place % 64;
    }
  }
}

bool volume_index::is_box(const float min[3], const float max[3]) noexcept {
  return min[0] <= max[0] && min[1] <= max[1] && min[2] <= max[2];
}

// A place is touched from its begin to the next one's: mirrored, the first one is the last one too. False where one is
// further away than volumes are.
bool volume_index::touched(const float min[3], const float max[3], touched_places& out) const noexcept {
  bool near = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
    near = near && std::fabs(min[axis]) < axes_[axis].near && std::fabs(max[axis]) < axes_[axis].near;
  for (std::size_t axis = 0; axis < 3 && near; ++axis) {
    out.first[axis] = ~axes_[axis].last_begun(-min[axis]);
    out.last[axis] = axes_[axis].last_begun(max[axis]);
  }
  return near || touched_far_away(min, max, out);
}

bool volume_index::touched_far_away(const float min[3], const float max[3], touched_places& out) const noexcept {
  bool near = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t first = ~axes_[axis].last_begun_far_away(-min[axis]);
    const std::int64_t last = axes_[axis].last_begun_far_away(max[axis]);
    near = near && first >= -place_limit && last < place_limit;
    out.first[axis] = static_cast<std::int32_t>(first);
    out.last[axis] = static_cast<std::int32_t>(last);
  }
  return near;
}

// Most boxes lie in one chunk.
bool volume_index::box_visible(const float min[3], const float max[3],
                               std::span<const std::uint64_t> visible) const noexcept {
  touched_places box;
  if (slots_.empty() || visible.size() < chunks_ || !is_box(min, max) || !touched(min, max, box)) return true;
  const auto& [first, last] = box;
  const std::int32_t apart = (first[0] ^ last[0]) | (first[1] ^ last[1]) | (first[2] ^ last[2]);
  if (chunk_of(apart) != 0) return several_visible(box, visible);
  const std::uint64_t rows = range_bits(last[1] - first[1], first[1] & 3, 0x0001000100010001u, 16) *
                             range_bits(last[2] - first[2], first[2] & 3, 0x1111u, 4);
  const std::uint64_t places = rows * range_bits(last[0] - first[0], first[0] & 3, 0xFu, 1);
  const volume_chunk& chunk = find(chunk_of(first[0]), chunk_of(first[1]), chunk_of(first[2]));
  return (places & (~chunk.places | visible[chunk.number])) != 0;
}

bool volume_index::several_visible(const touched_places& box, std::span<const std::uint64_t> visible) const noexcept {
  // Bits of an axis of the chunk that begins at a place.
  const auto bits_of = [&](std::size_t axis, std::int32_t begin, std::uint64_t four_bits, std::int32_t stride) {
    const std::int32_t from = std::max(box.first[axis] - begin, 0);
    const std::int32_t to = std::min(box.last[axis] - begin, chunk_width - 1);
    return range_bits(to - from, from, four_bits, stride);
  };
  for (std::int32_t y = chunk_of(box.first[1]); y <= chunk_of(box.last[1]); ++y) {
    const std::uint64_t layers = bits_of(1, chunk_width * y, 0x0001000100010001u, 16);
    for (std::int32_t z = chunk_of(box.first[2]); z <= chunk_of(box.last[2]); ++z) {
      const std::uint64_t rows = layers * bits_of(2, chunk_width * z, 0x1111u, 4);
      for (std::int32_t x = chunk_of(box.first[0]); x <= chunk_of(box.last[0]); ++x) {
        const std::uint64_t places = rows * bits_of(0, chunk_width * x, 0xFu, 1);
        const volume_chunk& chunk = find(x, y, z);
        if ((places & (~chunk.places | visible[chunk.number])) != 0) return true;
      }
    }
  }
  return false;
}

}  // namespace sightcell::runtime
