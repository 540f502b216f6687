#include "touched/tested_viewpoints.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr std::size_t bytes_of_point = 12, bytes_of_result = bytes_of_point + 1;

}  // namespace

std::array<std::uint32_t, 3> tested_viewpoints::bits_of(const glm::vec3& point) {
  return {std::bit_cast<std::uint32_t>(point.x), std::bit_cast<std::uint32_t>(point.y),
          std::bit_cast<std::uint32_t>(point.z)};
}

void tested_viewpoints::know(tested_viewpoints earlier, const edited_boxes& edit) {
  known_ = std::move(earlier.added_);
  std::sort(known_.begin(), known_.end());
  edit_ = &edit;
}

std::optional<std::uint8_t> tested_viewpoints::find(const glm::vec3& point) const {
  const std::array<std::uint32_t, 3> bits = bits_of(point);
  const auto found = std::lower_bound(known_.begin(), known_.end(), bits,
                                      [](const result& known, const auto& wanted) { return known.point < wanted; });
  if (found == known_.end() || found->point != bits) return std::nullopt;
  return found->valid;
}

void tested_viewpoints::add(const glm::vec3& point, std::uint8_t valid) {
  added_.push_back({bits_of(point), valid});
}

std::vector<std::uint8_t> tested_viewpoints::encode() {
  std::sort(added_.begin(), added_.end());
  added_.erase(std::unique(added_.begin(), added_.end()), added_.end());
  std::vector<std::uint8_t> bytes(added_.size() * bytes_of_result);
  std::uint8_t* to = bytes.data();
  for (const result& one : added_) {
    std::memcpy(to, one.point.data(), bytes_of_point);
    to[bytes_of_point] = one.valid;
    to += bytes_of_result;
  }
  return bytes;
}

tested_viewpoints tested_viewpoints::decode(std::span<const std::uint8_t> bytes) {
  tested_viewpoints tested;
  for (; bytes.size() >= bytes_of_result; bytes = bytes.subspan(bytes_of_result)) {
    result& one = tested.added_.emplace_back();
    std::memcpy(one.point.data(), bytes.data(), bytes_of_point);
    one.valid = bytes[bytes_of_point] != 0 ? 1 : 0;
  }
  return tested;
}

}  // namespace sightcell::bake
