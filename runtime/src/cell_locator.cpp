#include "cell_locator.h"

namespace sightcell::runtime {

bool cell_locator::build(const format::reader& file, const locator_memory& memory) noexcept {
  on_lattice_ = file.lattice() != nullptr;
  if (on_lattice_) return lattice_.build(*file.lattice(), file.cell_count(), memory.slots);
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    if (file.cell_box(cell, memory.cells[cell].bounds) != format::status::ok) return false;
    memory.cells[cell].cell = cell;
  }
  tree_.build(memory.cells, memory.nodes);
  return true;
}

}  // namespace sightcell::runtime
