#include "finish/dilation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
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

void expand(const ray_scene& rays, const vertex_neighbors& neighbors, const dilation_settings& how, std::uint64_t round,
            std::uint32_t member, const cell_set& set, expansion& out) {
  thread_local std::vector<std::uint32_t> near;
  thread_local sight seen;
  near.clear();
  const glm::vec3 eye = set.witness(member);
  neighbors.for_each(member, [&](std::uint32_t neighbor) {
    if (!set.contains(neighbor)) near.push_back(neighbor);
  });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  random_stream random(how.seed, how.place, purpose::dilation, round, member);
  const auto note = [&](std::uint32_t polygon) {
    if (polygon != no_polygon && !set.contains(polygon)) out.found.push_back({polygon, eye});
  };
  for (const std::uint32_t neighbor : near) {
    if (!faces(rays, neighbor, eye)) continue;  // its back cannot be seen from here
    const triangle corners = corners_of(rays.geometry(), neighbor);
    for (int i = 0; i < rays_per_neighbor; ++i) {
      const glm::vec3 toward = random_point(corners, random) - eye;
      const float length = glm::length(toward);
      if (!(length > 0.0f)) continue;
      rays.look(eye, toward / length, seen);
      ++out.rays;
      note(seen.front);
      for (const std::uint32_t polygon : seen.before) note(polygon);
      const bool hit = seen.front == neighbor || std::binary_search(seen.before.begin(), seen.before.end(), neighbor);
      if (hit) break;  // it has joined: the other tries would tell nothing
    }
  }
}

}  // namespace

std::uint64_t dilate(const ray_scene& rays, const vertex_neighbors& neighbors, const dilation_settings& how,
                     std::size_t first, std::uint64_t& round, cell_set& set) {
  std::uint64_t spent = 0;
  while (first < set.members().size() && spent < how.max_rays) {
    // A wave expands from one state of the set: finds are merged after it, in the order of the members.
    const std::size_t end = set.members().size();
    std::vector<expansion> wave(end - first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, end, 64), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        expand(rays, neighbors, how, round, set.members()[i], set, wave[i - first]);
    });
    for (const expansion& e : wave) {
      spent += e.rays;
      for (const found_polygon& f : e.found) set.add(f.polygon, f.eye);
    }
    first = end;
    ++round;
  }
  return spent;
}

}  // namespace sightcell::bake
