#pragma once
// What is seen from a cell, by independent rays: from places uniform over the free ones of its grown box, in directions
// uniform on the sphere. No random number of it is any sampler's.
//
// Whether an eye can be at a place takes 64 rays to tell, so half as many are cast from each. Fewer waste that time;
// more say little where few places see much that is missed, as those under a bench. Rays of one place are not
// independent: what is counted is counted by place, too.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/samplers/ground.h"
#include "bench/samplers/kept_files.h"
#include "sightcell/base/random.h"

namespace sightcell::bench {

inline constexpr std::uint32_t rays_of_place = 32;

// A place from where a polygon was seen, with the first of the rays that saw it.
struct truth_place {
  glm::vec3 eye{0.0f}, direction{0.0f};
  float distance = 0.0f;
  std::uint32_t number = 0;  // of the place, among all of the cell
  std::uint32_t rays = 0;    // that saw the polygon from there
  // In which places are kept: the same for all polygons, so that those seen from the same places keep the same ones.
  // Uniform in (0, 1].
  double order() const { return (static_cast<double>(bake::mix_bits(number) >> 11) + 1.0) * 0x1p-53; }
};

struct truth_polygon {
  static constexpr std::uint32_t kept_most = 4;
  std::uint32_t polygon = 0;
  std::uint32_t rays = 0;                            // how many saw it,
  std::uint32_t places = 0;                          // from how many places,
  std::uint64_t squares = 0;                         // and the sum of the squares of how many from each
  std::array<truth_place, kept_most> kept_places{};  // the first by order(), so a uniform sample
  std::uint32_t kept() const { return places < kept_most ? places : kept_most; }
};

class cell_truth {
 public:
  // g must outlive the object.
  cell_truth(const ground& g, std::size_t cell) : ground_(&g), cell_(cell) {}

  // Casts until there are so many rays (rounded up; fewer where free places are too rare). On the calling thread's TBB
  // arena; the result does not depend on its threads, nor on the steps in which a number was reached.
  void extend(std::uint64_t rays);

  std::uint64_t rays() const { return rays_; }
  double valid_share() const { return tries_ > 0 ? static_cast<double>(places_) / static_cast<double>(tries_) : 0.0; }
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
