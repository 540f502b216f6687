#include "cell_set/point_order.h"

#include <algorithm>

namespace sightcell::bake {

void sort_unique(std::vector<glm::vec3>& points) {
  const auto sorted = std::is_sorted_until(points.begin(), points.end(), is_lower);
  std::sort(sorted, points.end(), is_lower);
  std::inplace_merge(points.begin(), sorted, points.end(), is_lower);
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

}  // namespace sightcell::bake
