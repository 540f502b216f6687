#pragma once
// The rays of agvs: the origin and direction of each kind.
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
  random,      // from a random point of a cell in a random direction
  object,      // from a polygon in a random direction in front of it
  two_point,   // from a polygon toward a point of a cell
  mutation,    // close to a ray that found something new
  silhouette,  // from the origin of such a ray past an edge of the polygon that it found
  reverse      // from a polygon that was occluded, past an edge of the occluder
};
inline constexpr std::size_t ray_kinds = 6;

// A viewpoint in a cell from where a polygon was found for the first time.
struct mutation_candidate {
  glm::vec3 eye{0.0f};
  glm::vec3 point{0.0f};  // on the polygon
  std::uint32_t polygon = no_polygon;
  std::uint32_t uses = 0;
  std::uint64_t number = 0;  // the newest has the highest
};

// A ray from close to an earlier ray, which went from eye to point, hit an occluder before it reached aim.
struct blocked_ray {
  glm::vec3 eye{0.0f}, point{0.0f}, aim{0.0f};
  glm::vec3 hit{0.0f};
  std::uint32_t occluder = no_polygon;
};

// A ray to cast for all cells.
struct global_ray {
  glm::vec3 origin{0.0f};
  glm::vec3 direction{0.0f};  // unit vector; 0: no ray
  bool origin_is_free = false;
  // For mutations: the polygon and the point that the earlier ray hit, and the point that this ray is aimed at.
  std::uint32_t polygon = no_polygon;
  glm::vec3 point{0.0f}, aim{0.0f};
};

// Makes rays of each kind.
class global_rays {
 public:
  // cells: must outlive the object.
  global_rays(const ray_scene& rays, std::span<const box> cells);
  // Finds valid viewpoints of the cells on the calling thread's TBB arena. Must be called before the first ray. From
  // then on rays start in cells that have some, and are aimed at them. Returns false if no cell has any.
  // places: of the cells, keys of the random numbers.
  bool find_viewpoints(float player_radius, std::uint64_t seed, std::span<const std::uint64_t> places);

  // Each of these returns a ray of the kind of its name; its direction is 0 if it made none.
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
  std::vector<std::vector<glm::vec3>> free_;  // valid viewpoints per cell
  std::vector<std::uint32_t> with_free_;      // cells that have some
  std::vector<std::uint32_t> polygons_;       // that can be visible, in an order that depends on geometry
  float off_surface_;                         // distance of the origin of a ray from its polygon, meters
};

// Chooses how many rays of each kind a round casts, from the number of finds per ray in recent rounds.
class adaptive_shares {
 public:
  static constexpr double least = 0.02;  // of all rays, for every kind, because its finds may increase later
  // limits: largest number of rays of each kind.
  std::array<std::uint64_t, ray_kinds> rays_of_round(std::uint64_t rays,
                                                     const std::array<std::uint64_t, ray_kinds>& limits) const;
  // Records how many pairs (cell, polygon) the rays of one kind found in a round.
  void found(ray_kind kind, std::uint64_t rays, std::uint64_t pairs);

 private:
  std::array<double, ray_kinds> per_ray_{1, 1, 1, 1, 1, 1};
};

}  // namespace sightcell::bake
