#pragma once
// The set of visible volumes of one cell while it grows.
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::bake {

class volume_set {
 public:
  explicit volume_set(std::uint32_t count) : bits_((count + 63) / 64) {}

  static constexpr std::size_t bytes_for(std::uint32_t count) { return (std::size_t{count} + 63) / 64 * 8; }

  bool contains(std::uint32_t volume) const { return (bits_[volume / 64] >> volume % 64 & 1u) != 0; }
  // Adds a volume. Returns whether it is new.
  bool add(std::uint32_t volume) {
    const bool fresh = !contains(volume);
    bits_[volume / 64] |= std::uint64_t{1} << volume % 64;
    return fresh;
  }
  void clear() { bits_.assign(bits_.size(), 0); }

  // Returns the members, ascending.
  std::vector<std::uint32_t> members() const {
    std::vector<std::uint32_t> all;
    for (std::size_t word = 0; word < bits_.size(); ++word)
      for (std::uint64_t left = bits_[word]; left != 0; left &= left - 1)
        all.push_back(static_cast<std::uint32_t>(64 * word) + static_cast<std::uint32_t>(std::countr_zero(left)));
    return all;
  }

 private:
  std::vector<std::uint64_t> bits_;
};

}  // namespace sightcell::bake
