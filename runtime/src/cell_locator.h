#pragma once
// Finds the view cell of a position, for cells on a lattice and for boxes: the smallest volume, then the lowest number.
#include <cstdint>
#include <span>

#include "box_tree.h"
#include "lattice_index.h"
#include "nearest_cell.h"
#include "sightcell/format/reader.h"

namespace sightcell::runtime {

// Memory of the locator. Belongs to the caller and must outlive the locator.
struct locator_memory {
  std::span<lattice_slot> slots;  // lattice_index::slot_count(); none without a lattice
  std::span<located_cell> cells;  // one per cell; none with a lattice
  std::span<tree_node> nodes;     // box_tree::node_count(); none with a lattice
};

class cell_locator {
 public:
  // False if the bytes of the file changed since it was opened, or if its cells were constructed to make lookups slow.
  [[nodiscard]] bool build(const format::reader& file, const locator_memory& memory) noexcept;

  // As in box_tree.
  [[nodiscard]] std::uint32_t find(const rounded_point& position, double volume_limit,
                                   format::box& out) const noexcept {
    return on_lattice_ ? lattice_.find(position, volume_limit, out) : tree_.find(position, volume_limit, out);
  }
  [[nodiscard]] bool has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept {
    return on_lattice_ ? lattice_.has_smaller_inside(bounds, volume_limit)
                       : tree_.has_smaller_inside(bounds, volume_limit);
  }
  [[nodiscard]] std::size_t touching(const wide_box& closed, std::span<located_cell> dst) const noexcept {
    return on_lattice_ ? lattice_.touching(closed, dst) : tree_.touching(closed, dst);
  }
  void nearest(nearest_search& search) const noexcept {
    if (on_lattice_) {
      lattice_.nearest(search);
    } else {
      tree_.nearest(search);
    }
  }

  // Calls emit(box, first cell, cells) for groups of consecutive cells that are all inside the box.
  template <class Emit>
  void for_each_group(const Emit& emit) const noexcept {
    for (const lattice_slot& slot : lattice_.slots()) {
      if (slot.mask == 0) continue;
      emit(lattice_.bounds_of(slot), slot.first_cell(), count_bits(slot.mask));
    }
    for (const located_cell& c : tree_.cells()) emit(widened(c.bounds), c.cell, 1u);
  }

 private:
  lattice_index lattice_;
  box_tree tree_;
  bool on_lattice_ = false;
};

}  // namespace sightcell::runtime
