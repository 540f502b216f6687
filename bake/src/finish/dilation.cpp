#include "finish/dilation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <vector>

#include "free_space.h"
#include "random.h"
#include "rays/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr int rays_per_neighbor = 4;

struct found_polygon {
  std::uint32_t polygon;
  glm::vec3 eye;
  bool operator<(const found_polygon& other) const {
    return std::tie(polygon, eye.x, eye.y, eye.z) < std::tie(other.polygon, other.eye.x, other.eye.y, other.eye.z);
  }
};

// What one member's expansion found.
struct expansion {
  std::vector<found_polygon> found;
  std::uint64_t rays = 0;
};

// Uniform on the triangle.
glm::vec3 random_point(const triangle& t, random_stream& random) {
  const float root = std::sqrt(random.uniform()), v = random.uniform();
  return t[0] * (1.0f - root) + t[1] * (root * (1.0f - v)) + t[2] * (root * v);
}

// Random numbers are named by where polygons are and never by their ids: the same scene in another order of nodes, or
// with its instances written another way, is cast the same rays.
std::uint64_t name_of(const triangle& t) {
  std::uint64_t name = 0;
  for (const glm::vec3& corner : t) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis)
      h = (h ^ std::bit_cast<std::uint32_t>(corner[axis] + 0.0f)) * 0x9E3779B97F4A7C15u;
    name += h ^ (h >> 32);  // a sum: whichever corner comes first
  }
  return name;
}

class expander {
 public:
  expander(const ray_scene& rays, const near_polygons& neighbors, const dilation_settings& how, const cell_set& set)
      : rays_(rays), neighbors_(neighbors), how_(how), set_(set) {}

  void expand(std::uint32_t member, std::uint64_t round, expansion& out) {
    near_.clear();
    eye_ = set_.witness(member);
    neighbors_.for_each(member, [&](std::uint32_t neighbor) {
      if (!set_.contains(neighbor)) near_.push_back(neighbor);
    });
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
    const std::uint64_t here = name_of(corners_of(rays_.geometry(), member));
    for (const std::uint32_t neighbor : near_) {
      if (!faces(rays_, neighbor, eye_)) continue;  // its back cannot be seen from here
      const triangle corners = corners_of(rays_.geometry(), neighbor);
      random_stream random(how_.seed, how_.place, purpose::dilation, round, here - name_of(corners));
      for (int i = 0; i < rays_per_neighbor; ++i) {
        const glm::vec3 toward = random_point(corners, random) - eye_;
        const float length = glm::length(toward);
        if (!(length > 0.0f)) continue;
        ++out.rays;
        if (aim(toward / length, length, neighbor, out)) break;  // it has joined: other tries would tell nothing
      }
    }
  }

 private:
  // Notes all that the ray sees; true when the target is among it.
  bool aim(const glm::vec3& direction, float length, std::uint32_t target, expansion& out) {
    rays_.look(eye_, direction, seen_);
    bool hit = seen_.front == target;
    note(seen_.front, direction, seen_.distance, out);
    for (const passed_polygon& p : seen_.before) {
      note(p.polygon, direction, p.distance, out);
      hit = hit || p.polygon == target;
    }
    // Rule 2: what is hit where the target ought to be may lie in the same place.
    if (hit || !(std::abs(seen_.distance - length) <= coincidence_reach(seen_.distance))) return hit;
    rays_.coincident(eye_, direction, seen_.distance, coincident_);
    for (const std::uint32_t polygon : coincident_) {
      note(polygon, direction, seen_.distance, out);
      hit = hit || polygon == target;
    }
    return hit;
  }

  void note(std::uint32_t polygon, const glm::vec3& direction, float distance, expansion& out) const {
    if (polygon == no_polygon || set_.contains(polygon)) return;
    if (rays_.through_gap(eye_, direction, distance, how_.smallest_gap)) return;
    out.found.push_back({polygon, eye_});
  }

  const ray_scene& rays_;
  const near_polygons& neighbors_;
  const dilation_settings& how_;
  const cell_set& set_;
  glm::vec3 eye_{0.0f};
  std::vector<std::uint32_t> near_, coincident_;
  sight seen_;
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
