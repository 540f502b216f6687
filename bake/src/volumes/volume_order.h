#pragma once
// In which order a file has its volumes: what is seen together lies together, as with polygons.
#include <cstdint>
#include <functional>
#include <vector>

namespace sightcell::bake {

// [i]: which volume is i-th. volumes_of puts the ascending volumes of a cell into its argument, which comes empty; it
// is asked seven times for each cell, ascending, and what it throws comes through. The same answer on any number of
// threads (order/polygon_order.h).
std::vector<std::uint32_t> order_volumes(
    std::uint32_t volume_count, std::uint32_t cell_count,
    const std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& volumes)>& volumes_of);

}  // namespace sightcell::bake
