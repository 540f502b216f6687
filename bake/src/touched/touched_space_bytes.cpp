// The bytes of touched space in kept records. A file of its own, because the rasterizer is built without zlib for other
// platforms.
#include <zlib.h>

#include <cmath>
#include <cstring>

#include "touched/touched_space.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t head_size = 4 * sizeof(float) + 2;

}  // namespace

std::vector<std::uint8_t> touched_space::encode() const {
  const float head[4] = {middle_.x, middle_.y, middle_.z, half_};
  uLongf size = compressBound(static_cast<uLong>(rows_.size() * sizeof(rows_[0])));
  std::vector<std::uint8_t> bytes(head_size + size);
  std::memcpy(bytes.data(), head, sizeof(head));
  bytes[sizeof(head)] = static_cast<std::uint8_t>(levels_);
  bytes[sizeof(head) + 1] = escapes_ ? 1 : 0;
  // Fails only where the room is too small.
  (void)compress2(bytes.data() + head_size, &size, reinterpret_cast<const Bytef*>(rows_.data()),
                  static_cast<uLong>(rows_.size() * sizeof(rows_[0])), Z_DEFAULT_COMPRESSION);
  bytes.resize(head_size + size);
  return bytes;
}

std::optional<touched_space> touched_space::decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < head_size) return std::nullopt;
  float head[4];
  std::memcpy(head, bytes.data(), sizeof(head));
  touched_space space;
  space.middle_ = {head[0], head[1], head[2]};
  space.half_ = head[3];
  space.levels_ = bytes[sizeof(head)];
  space.escapes_ = bytes[sizeof(head) + 1] != 0;
  if (space.levels_ < 1 || space.levels_ > most_levels || !(space.half_ >= 1e-3f)) return std::nullopt;
  for (const float value : head)
    if (!(std::abs(value) < 1e9f)) return std::nullopt;
  space.rows_.resize(rows_of_level * static_cast<std::size_t>(space.levels_));
  uLongf size = static_cast<uLongf>(space.rows_.size() * sizeof(space.rows_[0]));
  const uLongf wanted = size;
  const auto body = bytes.subspan(head_size);
  if (uncompress(reinterpret_cast<Bytef*>(space.rows_.data()), &size, body.data(), static_cast<uLong>(body.size())) !=
          Z_OK ||
      size != wanted)
    return std::nullopt;
  return space;
}

}  // namespace sightcell::bake
