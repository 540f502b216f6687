#include "commands.h"

#include <cstring>
#include <span>

namespace sightcell::runtime {
namespace {

void write_command(const sightcell_db& db, const sightcell_range& r, std::byte* dst) noexcept {
  // In the one index buffer of a merged scene, the polygons of a group follow those of the groups before it.
  const std::uint32_t first = db.is_merged() ? db.range_borders()[r.draw] + r.first : r.first;
  const sightcell_command command{3 * r.count, 1, 3 * first, db.base_vertex(r.draw), r.draw};
  std::memcpy(dst, &command, sizeof command);
}

// Counts the commands, and writes them unless dst is null.
std::uint64_t list_commands(const sightcell_view& view, std::uint32_t min_gap, std::byte* dst,
                            std::size_t stride) noexcept {
  const std::span<const sightcell_range> ranges = view.ranges();
  std::uint64_t commands = 0;
  for (std::size_t i = 0; i < ranges.size();) {
    sightcell_range held = ranges[i++];
    for (; i < ranges.size() && ranges[i].draw == held.draw; ++i) {
      const sightcell_range& next = ranges[i];
      if (next.first - (held.first + held.count) >= min_gap) break;
      held.count = next.first + next.count - held.first;
    }
    ++commands;
    if (dst == nullptr) continue;
    write_command(view.db(), held, dst);
    dst += stride;
  }
  return commands;
}

}  // namespace

std::uint64_t count_commands(const sightcell_view& view, std::uint32_t min_gap) noexcept {
  return list_commands(view, min_gap, nullptr, 0);
}

void write_commands(const sightcell_view& view, std::uint32_t min_gap, std::byte* dst, std::size_t stride) noexcept {
  static_cast<void>(list_commands(view, min_gap, dst, stride));
}

}  // namespace sightcell::runtime
