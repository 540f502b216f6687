#include "stream/sketches.h"

#include <algorithm>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

// Classes from here on are one level: they are solid angles below any measured one.
constexpr std::uint32_t levels = 12;

// Never unseen_component.
std::uint32_t element_hash(std::uint32_t cell, std::uint32_t level, std::size_t component) {
  const std::uint64_t element = std::uint64_t{cell} * levels + level;
  return static_cast<std::uint32_t>(mix_bits(mix_bits(element + 0x9E3779B97F4A7C15u) + component) >> 33);
}

}  // namespace

void join(sketch& into, const sketch& other) {
  for (std::size_t i = 0; i < sketch_size; ++i) into[i] = std::min(into[i], other[i]);
}

sketch sketch_table::nothing() {
  sketch out;
  out.fill(unseen_component);
  return out;
}

void sketch_table::begin_cell(std::uint32_t cell) {
  of_level_.assign(levels, nothing());
  for (std::uint32_t level = 0; level < levels; ++level) {
    if (level > 0) of_level_[level] = of_level_[level - 1];
    for (std::size_t i = 0; i < sketch_size; ++i)
      of_level_[level][i] = std::min(of_level_[level][i], element_hash(cell, level, i));
  }
}

void sketch_table::add(std::size_t item, std::uint8_t one) {
  join(sketches_[item], of_level_[levels - 1 - std::min<std::uint32_t>(one, levels - 1)]);
}

}  // namespace sightcell::bake
