#include "file/kept_sets.h"

#include <utility>

#include "cell_set/set_bytes.h"

namespace sightcell::bake {

void kept_sets::keep(std::uint32_t cell, const std::vector<std::uint32_t>& set) {
  std::vector<std::uint8_t> bytes;
  put_set(bytes, set);
  if (bytes.size() > room_) return;
  bytes.shrink_to_fit();
  room_ -= bytes.size();
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

}  // namespace sightcell::bake
