#pragma once
// Place -> view cell, whichever way a file has its cells: the smallest volume wins, then the lowest number.
#include <cstdint>
#include <span>

#include "box_tree.h"
#include "lattice_index.h"
#include "nearest_cell.h"
#include "sightcell/format/reader.h"

namespace sightcell::runtime {

// What the locator lives in; belongs to whoever builds it, and must outlive it.
struct locator_memory {
  std::span<lattice_slot> slots;  // lattice_index::slot_count(); none without a lattice
  std::span<located_cell> cells;  // one per cell; none with a lattice
  std::span<tree_node> nodes;     // box_tree::node_count(); none with a lattice
};

class cell_locator {
 public:
  // False when the file's bytes changed since it was opened, or somebody chose its cells so that they cannot be looked
  // up quickly.
  [[nodiscard]] bool build(const format::reader& file, const locator_memory& memory) noexcept;

  // As box_tree has them.
  [[nodiscard]] std::uint32_t find(const rounded_point& place, double volume_limit, format::box& out) const noexcept {
    return on_lattice_ ? lattice_.find(place, volume_limit, out) : tree_.find(place, volume_limit, out);
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

  // Calls emit(box, first cell, cells) for groups of cells that follow each other and all lie in the box.
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
