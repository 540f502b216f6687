#include "stream/polygon_numbers.h"

#include <algorithm>

namespace sightcell::bake {

polygon_numbers::polygon_numbers(const scene::gltf_pager& pager) {
  begin_.push_back(0);
  for (const scene::streamed_geometry& g : pager.geometries()) begin_.push_back(begin_.back() + g.polygon_count);
  const scene::scene& s = pager.content();
  draw_of_.resize(s.polygon_count);
  for (std::uint32_t number = 0; number < s.draws.size(); ++number) {
    const scene::draw& d = s.draws[number];
    const auto begin = draw_of_.begin() + static_cast<std::ptrdiff_t>(d.first_source);
    std::fill(begin, begin + static_cast<std::ptrdiff_t>(d.polygon_count), number);
    offset_.push_back(begin_[pager.geometry_of_draw()[number]] - d.first_source);
  }
}

}  // namespace sightcell::bake
