// The bytes of touched space in kept records. A file of its own, because the rasterizer is built without zlib for other
// platforms.
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "touched/touched_space.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t place_size = 4 * sizeof(float) + 2, head_size = place_size + sizeof(std::uint64_t);
constexpr std::uint64_t largest_ratio = 1100;  // of what is deflated; the format allows less

}  // namespace

std::vector<std::uint8_t> touched_space::encode() const {
  const float head[4] = {middle_.x, middle_.y, middle_.z, half_};
  const auto* rows = reinterpret_cast<const std::uint8_t*>(rows_.data());
  std::vector<std::uint8_t> body(rows, rows + rows_.size() * sizeof(rows_[0]));
  const std::vector<std::uint8_t> faces = faces_.encode();
  body.insert(body.end(), faces.begin(), faces.end());
  const std::uint64_t whole = body.size();
  uLongf size = compressBound(static_cast<uLong>(whole));
  std::vector<std::uint8_t> bytes(head_size + size);
  std::memcpy(bytes.data(), head, sizeof(head));
  bytes[sizeof(head)] = static_cast<std::uint8_t>(levels_);
  bytes[sizeof(head) + 1] = escapes_ ? 1 : 0;
  std::memcpy(bytes.data() + place_size, &whole, sizeof(whole));
  // Fails only where the room is too small.
  (void)compress2(bytes.data() + head_size, &size, body.data(), static_cast<uLong>(whole), Z_BEST_SPEED);
  bytes.resize(head_size + size);
  return bytes;
}

std::optional<touched_space> touched_space::decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < head_size) return std::nullopt;
  float head[4];
  std::memcpy(head, bytes.data(), sizeof(head));
  std::uint64_t whole = 0;
  std::memcpy(&whole, bytes.data() + place_size, sizeof(whole));
  touched_space space;
  space.middle_ = {head[0], head[1], head[2]};
  space.half_ = head[3];
  space.levels_ = bytes[sizeof(head)];
  space.escapes_ = bytes[sizeof(head) + 1] != 0;
  if (space.levels_ < 1 || space.levels_ > most_levels || !(space.half_ >= 1e-3f)) return std::nullopt;
  for (const float value : head)
    if (!(std::abs(value) < 1e9f)) return std::nullopt;
  const auto deflated = bytes.subspan(head_size);
  space.rows_.resize(rows_of_level * static_cast<std::size_t>(space.levels_));
  const std::size_t of_rows = space.rows_.size() * sizeof(space.rows_[0]);
  if (whole < of_rows || whole > largest_ratio * deflated.size()) return std::nullopt;
  std::vector<std::uint8_t> body(static_cast<std::size_t>(whole));
  uLongf size = static_cast<uLongf>(whole);
  if (uncompress(body.data(), &size, deflated.data(), static_cast<uLong>(deflated.size())) != Z_OK || size != whole)
    return std::nullopt;
  std::memcpy(space.rows_.data(), body.data(), of_rows);
  std::optional<touched_faces> faces = touched_faces::decode(std::span<const std::uint8_t>(body).subspan(of_rows));
  if (!faces) return std::nullopt;
  space.faces_ = std::move(*faces);
  return space;
}

}  // namespace sightcell::bake
