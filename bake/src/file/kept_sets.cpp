#include "file/kept_sets.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "cell_set/set_bytes.h"

namespace sightcell::bake {

std::vector<std::uint8_t> kept_sets::bytes_of(const std::vector<std::uint32_t>& set) {
  std::vector<std::uint8_t> bytes;
  // The encoder refuses a set that is not ascending when it is read.
  if (std::adjacent_find(set.begin(), set.end(), std::greater_equal<>()) != set.end()) return bytes;
  put_set(bytes, set);
  bytes.shrink_to_fit();
  return bytes;
}

void kept_sets::keep(std::uint32_t cell, std::vector<std::uint8_t> bytes) {
  if (bytes.empty() || bytes.size() > room_) return;
  room_ -= bytes.size();
  taken_ += bytes.size();
  bytes_.insert_or_assign(cell, std::move(bytes));
}

std::vector<std::uint32_t> kept_sets::of(std::uint32_t cell) const {
  const auto kept = bytes_.find(cell);
  if (kept == bytes_.end()) return record_of_(cell).set;
  byte_reader in{kept->second};
  std::vector<std::uint32_t> set;
  take_set(in, set);
  return set;
}

std::uint64_t kept_sets::mean_bytes() const {
  return bytes_.empty() ? 1 : taken_ / bytes_.size();
}

}  // namespace sightcell::bake
