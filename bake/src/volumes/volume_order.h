#pragma once
// The order in which a file stores visibility volumes. As with polygons, those that are visible from the same cells are
// adjacent.
#include <cstdint>
#include <functional>
#include <vector>

namespace sightcell::bake {

// Returns the stored order: element i is the volume that is stored as number i.
// volumes_of: appends the volumes of a cell, ascending, to an empty vector. It is called seven times for each cell, for
//   several cells at once. Its exceptions reach the caller.
// The result does not depend on the number of threads (order/polygon_order.h).
std::vector<std::uint32_t> order_volumes(
    std::uint32_t volume_count, std::uint32_t cell_count,
    const std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& volumes)>& volumes_of);

}  // namespace sightcell::bake
