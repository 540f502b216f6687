#include "volume_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

namespace sightcell::runtime {
namespace {

constexpr std::int32_t chunk_width = 4;

// The result of a search for a chunk that does not exist.
constexpr volume_chunk free_chunk;

std::int32_t chunk_of(std::int32_t place) noexcept {
  return place >> 2;  // rounds down, also below 0
}
static_assert(chunk_width == 4);

unsigned bit_of(const format::lattice_place& p) noexcept {
  return static_cast<unsigned>((p.x & 3) + 4 * (p.z & 3) + 16 * (p.y & 3));
}

// Gives neighbors distant values.
std::uint64_t hash_of(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
  const auto wide = [](std::int32_t value) { return std::uint64_t{static_cast<std::uint32_t>(value)}; };
  const std::uint64_t sum =
      wide(x) * 0x9E3779B97F4A7C15u + wide(y) * 0xC2B2AE3D27D4EB4Fu + wide(z) * 0x165667B19E3779F9u;
  return (sum ^ sum >> 32) * 0xD6E8FEB86659FD93u;
}

// Bit `from` of four bits that are `stride` apart, and the `more` bits after it.
std::uint64_t range_bits(std::int32_t more, std::int32_t from, std::uint64_t four_bits, std::int32_t stride) noexcept {
  return four_bits >> (stride * (chunk_width - 1 - more)) << (stride * from);
}

}  // namespace

volume_index::lattice_axes::lattice_axes(double width, double height) noexcept {
  size = {width, height, width, width};
  for (std::size_t i = 0; i < lanes; ++i) {
    inverse[i] = 1.0 / size[i];
    reach[i] = static_cast<float>(std::min(size[i] * 0x1p30, static_cast<double>(std::numeric_limits<float>::max())));
  }
}

// A border is rounded by up to half the distance of two floats. Where that is less than one position, the result is the
// quotient rounded down, or the next one. Where it is more, further positions may be touched; but then the position of
// the quotient, or the next one, has two equal borders: it is no volume, and touched. There are no branches, because no
// processor can predict where in a position the end of a box is.
inline void volume_index::lattice_axes::last_begun(const lane_floats& at, lane_places& out) const noexcept {
  for (std::size_t i = 0; i < lanes; ++i) {
    const auto toward_zero = static_cast<std::int32_t>(static_cast<double>(at[i]) * inverse[i]);
    const std::int32_t next = toward_zero + static_cast<std::int32_t>(at[i] >= 0.0f);
    out[i] = next - static_cast<std::int32_t>(static_cast<float>(next * size[i]) > at[i]);
  }
}

// The number of chunks is known only after a search, so this is an upper bound: volumes of one chunk are mostly
// consecutive, or alternate with those of a few neighboring ones.
void volume_index::measure(const format::volume_table& volumes) noexcept {
  *this = volume_index{};
  std::array<volume_chunk, 256> met{};
  std::uint64_t most = 0;  // an upper bound
  format::lattice_place p;
  for (std::uint32_t volume = 0; volume < volumes.count(); ++volume) {
    if (!volumes.place(volume, p)) continue;  // build reports it
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
  construct(first_slot, slots);
  construct(first_place, volumes_);
  slots_ = {first_slot, slots};
  places_ = {first_place, volumes_};
}

bool volume_index::build(const format::volume_table& volumes) noexcept {
  axes_ = lattice_axes(volumes.shape().width, volumes.shape().height);
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

// A position is touched from its begin to the begin of the next one. Mirrored at 0, the first one becomes the last one.
inline bool volume_index::touched(const float min[3], const float max[3], touched_places& out) const noexcept {
  const lane_floats low{-min[0], -min[1], -min[2], -min[2]};
  const lane_floats high{max[0], max[1], max[2], max[2]};
  std::int32_t beyond = 0;
  for (std::size_t i = 0; i < lanes; ++i) {
    beyond |= static_cast<std::int32_t>(!(std::fabs(low[i]) <= axes_.reach[i])) |
              static_cast<std::int32_t>(!(std::fabs(high[i]) <= axes_.reach[i])) |
              static_cast<std::int32_t>(!(-low[i] <= high[i]));
  }
  if (beyond != 0) return false;
  axes_.last_begun(low, out.first);
  axes_.last_begun(high, out.last);
  for (std::int32_t& first : out.first) first = ~first;
  return true;
}

// Most boxes are in one chunk.
bool volume_index::box_visible(const float min[3], const float max[3],
                               std::span<const std::uint64_t> visible) const noexcept {
  touched_places box;
  if (slots_.empty() || visible.size() < chunks_ || !touched(min, max, box)) return true;
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
  // The bits on one axis, of the chunk that begins at a position.
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
