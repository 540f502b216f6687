#pragma once
// Sketches of where polygons are visible: weighted min-hashes, whose similarity estimates that of the polygons' cells
// and solid angles without memory for these.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::bake {

// A polygon that covers a solid angle of class k in a cell has one element for each class from the least important one
// up to k. Component i of a sketch is the smallest of hash i of all elements. Two polygons share a component with the
// probability of elements in common over all elements (A. Z. Broder, "On the resemblance and containment of documents",
// 1997). The sketch of a union is the smaller one of each component.
inline constexpr std::size_t sketch_size = 32;
using sketch = std::array<std::uint32_t, sketch_size>;
inline constexpr std::uint32_t unseen_component = 0xFFFFFFFFu;  // in all components: visible from no cell

void join(sketch& into, const sketch& other);

class sketch_table {
 public:
  explicit sketch_table(std::size_t items) : sketches_(items, nothing()) {}

  // Chooses the cell of the next calls of add.
  void begin_cell(std::uint32_t cell);
  // one: importance class of the item in the cell.
  void add(std::size_t item, std::uint8_t one);

  const sketch& operator[](std::size_t item) const { return sketches_[item]; }

  static sketch nothing();

 private:
  std::vector<sketch> sketches_;
  std::vector<sketch> of_level_;  // of the cell: the smallest hashes of elements up to each level
};

}  // namespace sightcell::bake
