#include "finish/dilation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "finish/aim.h"
#include "free_space.h"
#include "random.h"
#include "rays/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr int rays_per_neighbor = 4;

// What one member's expansion found.
struct expansion {
  std::vector<found_polygon> found;
  std::uint64_t rays = 0;
};

class expander {
 public:
  expander(const ray_scene& rays, const near_polygons& neighbors, const dilation_settings& how, const cell_set& set)
      : rays_(rays), neighbors_(neighbors), how_(how), set_(set), aimed_(rays, how.smallest_gap, set) {}

  void expand(std::uint32_t member, std::uint64_t round, expansion& out) {
    near_.clear();
    const glm::vec3 eye = set_.witness(member);
    neighbors_.for_each(member, [&](std::uint32_t neighbor) {
      if (!set_.contains(neighbor)) near_.push_back(neighbor);
    });
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
    const std::uint64_t here = name_of(corners_of(rays_.geometry(), member));
    for (const std::uint32_t neighbor : near_) {
      if (!faces(rays_, neighbor, eye)) continue;  // its back cannot be seen from here
      const triangle corners = corners_of(rays_.geometry(), neighbor);
      random_stream random(how_.seed, how_.place, how_.use, round, here - name_of(corners));
      for (int i = 0; i < rays_per_neighbor; ++i) {
        ++out.rays;
        // Once it is seen other tries would tell nothing.
        if (aimed_.aim(eye, random_point(corners, random), neighbor, out.found)) break;
      }
    }
  }

 private:
  const ray_scene& rays_;
  const near_polygons& neighbors_;
  const dilation_settings& how_;
  const cell_set& set_;
  aimed_rays aimed_;
  std::vector<std::uint32_t> near_;
};

}  // namespace

std::uint64_t dilate(const ray_scene& rays, const near_polygons& neighbors, const dilation_settings& how,
                     std::size_t first, std::uint64_t& round, cell_set& set) {
  std::uint64_t spent = 0;
  std::vector<found_polygon> found;
  while (first < set.members().size() && spent < how.max_rays) {
    // A wave expands from one state of the set: finds are merged after it.
    const std::size_t end = set.members().size();
    std::vector<expansion> wave(end - first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, end, 64), [&](const auto& range) {
      expander from(rays, neighbors, how, set);
      for (std::size_t i = range.begin(); i < range.end(); ++i) from.expand(set.members()[i], round, wave[i - first]);
    });
    found.clear();
    for (const expansion& e : wave) {
      spent += e.rays;
      found.insert(found.end(), e.found.begin(), e.found.end());
    }
    // Of several eyes that saw a polygon in this wave the lowest is its witness: again not a matter of ids.
    std::sort(found.begin(), found.end());
    for (const found_polygon& f : found) set.add(f.polygon, f.eye);
    first = end;
    ++round;
  }
  return spent;
}

}  // namespace sightcell::bake
