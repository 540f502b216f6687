#include "commands.h"

#include <cstring>
#include <span>

namespace sightcell::runtime {
namespace {

template <class Emit>
void for_each_command(const sightcell_view& view, std::uint32_t min_gap, const Emit& emit) {
  sightcell_range held{};  // count 0: none
  for (const sightcell_range& r : view.ranges()) {
    if (held.count > 0 && held.draw == r.draw && r.first - (held.first + held.count) < min_gap) {
      held.count = r.first + r.count - held.first;
      continue;
    }
    if (held.count > 0) emit(held);
    held = r;
  }
  if (held.count > 0) emit(held);
}

}  // namespace

std::uint64_t count_commands(const sightcell_view& view, std::uint32_t min_gap) noexcept {
  std::uint64_t commands = 0;
  for_each_command(view, min_gap, [&](const sightcell_range&) { ++commands; });
  return commands;
}

void write_commands(const sightcell_view& view, std::uint32_t min_gap, std::byte* dst, std::size_t stride) noexcept {
  const sightcell_db& db = view.db();
  for_each_command(view, min_gap, [&](const sightcell_range& r) {
    // A group's polygons lie behind those of the groups before it in the one index buffer of the scene.
    const std::uint32_t first = db.is_merged() ? db.range_borders()[r.draw] + r.first : r.first;
    const sightcell_command command{3 * r.count, 1, 3 * first, db.base_vertex(r.draw), r.draw};
    std::memcpy(dst, &command, sizeof command);
    dst += stride;
  });
}

}  // namespace sightcell::runtime
