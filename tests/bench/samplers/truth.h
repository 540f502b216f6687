#pragma once
// What is seen from a cell, by independent rays: from places uniform over the free ones of its grown box, in directions
// uniform on the sphere. No random number of it is any sampler's.
//
// Whether an eye can be at a place takes 64 rays to tell, so from each as many are cast: against 16 that is twice the
// evidence in the same time. Rays of one place are not independent, so a ray's number says which place it is of.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/samplers/ground.h"
#include "bench/samplers/kept_files.h"

namespace sightcell::bench {

inline constexpr std::uint32_t rays_of_place = 64;

// One of the rays that saw a polygon.
struct truth_ray {
  glm::vec3 eye{0.0f}, direction{0.0f};
  float distance = 0.0f;
  std::uint32_t number = 0;
  std::uint32_t place() const { return number / rays_of_place; }
};

struct truth_polygon {
  static constexpr std::uint32_t kept_most = 4;
  std::uint32_t polygon = 0;
  std::uint32_t rays = 0;                        // how many saw it
  std::array<truth_ray, kept_most> kept_rays{};  // a uniform sample of them: those whose numbers mix to the least
  std::uint32_t kept() const { return rays < kept_most ? rays : kept_most; }
};

class cell_truth {
 public:
  // g must outlive the object.
  cell_truth(const ground& g, std::size_t cell) : ground_(&g), cell_(cell) {}

  // Casts until there are so many rays (rounded up; fewer where free places are too rare). On the calling thread's TBB
  // arena; the result does not depend on its threads, nor on the steps in which a number was reached.
  void extend(std::uint64_t rays);

  std::uint64_t rays() const { return rays_; }
  double free_share() const { return tries_ > 0 ? static_cast<double>(places_) / static_cast<double>(tries_) : 0.0; }
  double cpu_seconds() const { return cpu_seconds_; }  // that all of it took, on the machine that cast it
  const std::vector<truth_polygon>& polygons() const { return polygons_; }  // ascending

  const ground& on() const { return *ground_; }
  std::size_t cell() const { return cell_; }

  // By content. load() says whether there was something.
  std::string key() const;
  bool load(const kept_files& kept);
  void save(const kept_files& kept) const;

 private:
  const ground* ground_;
  std::size_t cell_;
  std::uint64_t chunks_ = 0, rays_ = 0, places_ = 0, tries_ = 0;
  double cpu_seconds_ = 0.0;
  std::vector<truth_polygon> polygons_;
};

}  // namespace sightcell::bench
