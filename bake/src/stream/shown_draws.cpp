#include "stream/shown_draws.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sightcell::bake {
namespace {

draw_matrix float_matrix(const scene::draw& d) {
  draw_matrix out{};
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) out[static_cast<std::size_t>(3 * c + r)] = static_cast<float>(d.to_world[c][r]);
  return out;
}

// Returns whether floats have the places of all that is in the box of a geometry.
bool fits_floats(const draw_matrix& m, const scene::streamed_geometry& g) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double most = std::abs(static_cast<double>(m[9 + axis]));
    for (int c = 0; c < 3; ++c)
      most += std::abs(static_cast<double>(m[static_cast<std::size_t>(3 * c) + axis])) *
              static_cast<double>(std::max(std::abs(g.min[c]), std::abs(g.max[c])));
    if (!std::isfinite(static_cast<float>(most))) return false;
  }
  return true;
}

}  // namespace

shown_draws::shown_draws(const scene::gltf_pager& pager) : draws_of_(pager.geometries().size()) {
  const std::vector<scene::draw>& draws = pager.content().draws;
  place_of_.resize(draws.size());
  std::map<draw_matrix, std::uint32_t> known;
  for (std::uint32_t number = 0; number < draws.size(); ++number) {
    const scene::draw& d = draws[number];
    if (d.tags.never || (d.lod_object != scene::no_index && d.lod_level > 0)) continue;
    const std::uint32_t geometry = pager.geometry_of_draw()[number];
    const draw_matrix matrix = float_matrix(d);
    if (!fits_floats(matrix, pager.geometries()[geometry])) continue;
    const auto [found, is_new] = known.try_emplace(matrix, static_cast<std::uint32_t>(matrices_.size()));
    if (is_new) matrices_.push_back(matrix);
    place_of_[number] = found->second;
    draws_of_[geometry].push_back(number);
  }
}

}  // namespace sightcell::bake
