#include "sampler/color_weight.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "hemicube/hemicube_faces.h"

namespace sightcell::bake {

double color_difference(const pose& where, const hemicube_view& view, hemicube_source& source, const ray_scene& rays,
                        const surface_colors& colors, const cell_set& set) {
  if (std::all_of(view.seen.begin(), view.seen.end(), [&](const seen_polygon& s) { return set.contains(s.id); }))
    return 0.0;
  hemicube_image image;
  source.render_image(where, image);
  const auto contains = [&](std::uint32_t polygon) { return set.contains(polygon); };
  const auto of_pixels = [&](const tbb::blocked_range<std::uint32_t>& range, std::uint64_t sum) {
    for (std::uint32_t pixel = range.begin(); pixel < range.end(); ++pixel) {
      const std::uint32_t id = image.ids[pixel];
      if (id == scene::no_index || contains(id)) continue;
      const glm::vec3 direction = pixel_direction(where, image.resolution, pixel);
      const std::uint32_t behind = rays.front_of_set(where.eye, direction, contains);
      const glm::u8vec3 whole = colors.color_of(id, where.eye, direction);
      const glm::u8vec3 found =
          behind == no_polygon ? surface_colors::sky() : colors.color_of(behind, where.eye, direction);
      for (int c = 0; c < 3; ++c) sum += static_cast<unsigned>(std::abs(whole[c] - found[c]));
    }
    return sum;
  };
  const auto pixels = static_cast<std::uint32_t>(image.ids.size());
  const std::uint64_t sum = tbb::parallel_reduce(tbb::blocked_range<std::uint32_t>(0, pixels, 4096), std::uint64_t{0},
                                                 of_pixels, std::plus<>());
  return static_cast<double>(sum) / (255.0 * 3.0 * pixels);
}

}  // namespace sightcell::bake
