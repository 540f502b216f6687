#include "volumes/volume_order.h"

#include <array>

#include "order/polygon_order.h"

namespace sightcell::bake {

std::vector<std::uint32_t> order_volumes(
    std::uint32_t volume_count, std::uint32_t cell_count,
    const std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& volumes)>& volumes_of) {
  const std::array<ordered_draw, 1> all{{{.unit = 0, .first = 0, .count = volume_count}}};
  order_input in;
  in.draws = all;
  in.unit_count = 1;
  in.cell_count = cell_count;
  in.runs_of = [&](std::uint32_t cell, std::vector<format::run>& runs) {
    std::vector<std::uint32_t> volumes;
    volumes_of(cell, volumes);
    for (const std::uint32_t volume : volumes) {
      if (!runs.empty() && runs.back().first + runs.back().count == volume)
        ++runs.back().count;
      else
        runs.push_back({.first = volume, .count = 1});
    }
  };
  return std::move(order_polygons(in, {}).units.front());
}

}  // namespace sightcell::bake
