#include "job/steps_in_work.h"

namespace sightcell::bake {

std::optional<slow_cell> longest_in_work(std::span<const step_in_work> steps, std::span<const view_cell> cells,
                                         work_clock::time_point now, double at_least) {
  const step_in_work* longest = nullptr;
  for (const step_in_work& one : steps)
    if (one.cell < cells.size() && (longest == nullptr || one.began < longest->began)) longest = &one;
  if (longest == nullptr) return std::nullopt;
  const double seconds = std::chrono::duration<double>(now - longest->began).count();
  if (seconds < at_least) return std::nullopt;
  const view_cell& cell = cells[longest->cell];
  const glm::vec3 center = 0.5f * (cell.min + cell.max);
  return slow_cell{longest->cell, {center.x, center.y, center.z}, seconds};
}

}  // namespace sightcell::bake
