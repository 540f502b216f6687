#pragma once
// The rays of agvs: where each kind of them begins and whither it goes.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

enum class ray_kind : std::uint8_t {
  random,      // from anywhere in a cell, anywhither
  object,      // from a polygon, anywhither in front of it
  two_point,   // from a polygon toward a place in a cell
  mutation,    // beside a ray that found something new
  silhouette,  // from where that ray was cast, past an edge of what it found
  reverse      // from what an occluder kept from being seen, past the occluder's edge
};
inline constexpr std::size_t ray_kinds = 6;

// A place in a cell from where a polygon was seen for the first time.
struct mutation_candidate {
  glm::vec3 eye{0.0f};
  glm::vec3 point{0.0f};  // on the polygon
  std::uint32_t polygon = no_polygon;
  std::uint32_t uses = 0;
  std::uint64_t number = 0;  // the newest has the highest
};

// A ray beside an earlier one that went from eye to point met an occluder before it came to aim.
struct blocked_ray {
  glm::vec3 eye{0.0f}, point{0.0f}, aim{0.0f};
  glm::vec3 hit{0.0f};
  std::uint32_t occluder = no_polygon;
};

struct global_ray {
  glm::vec3 origin{0.0f};
  glm::vec3 direction{0.0f};  // of length 1; 0: there is no such ray
  bool origin_is_free = false;
  // Of rays that may be blocked: where the earlier ray hit which polygon, and where this one is to arrive.
  std::uint32_t polygon = no_polygon;
  glm::vec3 point{0.0f}, aim{0.0f};
};

class global_rays {
 public:
  // cells: must outlive this.
  global_rays(const ray_scene& rays, std::span<const box> cells);
  // Before the first ray: looks for free places of the cells, on the calling thread's TBB arena. From then on rays
  // begin in and aim at cells that have some. places: of the cells, by which their random numbers are named. False
  // where no cell has any.
  bool find_viewpoints(float player_radius, std::uint64_t seed, std::span<const std::uint64_t> places);

  global_ray random(random_stream& numbers) const;
  global_ray object(random_stream& numbers) const;
  global_ray two_point(random_stream& numbers) const;
  global_ray mutation(const mutation_candidate& from, random_stream& numbers) const;
  global_ray silhouette(const mutation_candidate& from, random_stream& numbers) const;
  global_ray reverse(const blocked_ray& from, random_stream& numbers) const;

 private:
  std::uint32_t any_cell(random_stream& numbers) const;
  std::uint32_t any_polygon(random_stream& numbers) const;

  const ray_scene& rays_;
  std::span<const box> cells_;
  std::vector<std::vector<glm::vec3>> free_;  // places of each cell
  std::vector<std::uint32_t> with_free_;      // cells that have some
  std::vector<std::uint32_t> polygons_;       // that can be seen, in an order of geometry
  float off_surface_;                         // how far before a polygon its rays begin, metres
};

// How many rays of each kind a round casts, by what each found lately per ray.
class adaptive_shares {
 public:
  static constexpr double least = 0.02;  // of the rays, whatever a kind finds: what it may find changes
  // limits: how many there can be of each kind.
  std::array<std::uint64_t, ray_kinds> rays_of_round(std::uint64_t rays,
                                                     const std::array<std::uint64_t, ray_kinds>& limits) const;
  void found(ray_kind kind, std::uint64_t rays, std::uint64_t pairs);

 private:
  std::array<double, ray_kinds> per_ray_{1, 1, 1, 1, 1, 1};
};

}  // namespace sightcell::bake
