#pragma once
// Repeatable random numbers. A stream is identified by its use, never by thread, order or time.
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>

namespace sightcell::bake {

// Returns x with all bits mixed: the finalizer of splitmix64 (Steele, Lea, Flood 2014), a bijection.
constexpr std::uint64_t mix_bits(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

// The use of a stream, so that no two uses in one cell share numbers. The values affect results and must not change.
enum class purpose : std::uint64_t {
  viewpoints = 1,
  boundary = 2,
  interior = 3,
  dilation = 4,
  bound = 5,  // verification rays
  verify = 6,
  estimate = 7,
  neighbor_check = 8,      // neighbor check of phase 1, inside a block
  check_all = 9,           // neighbor check of phase 2, across blocks
  dilation_of_finds = 10,  // phase 2
  jitter = 11,
  guided = 13,      // rays of gvs and gvs++
  agvs = 14,        // rays for all cells
  agvs_place = 15,  // of a cell on such a ray
  importance = 16,
  volumes = 17,
  merging = 18,  // of cells
  caster_search = 19,
  caster_bound = 20,
  caster_verify = 21,
  light_verify = 22,
  found_before = 23  // of a cell that starts from what an earlier bake found
};

class random_stream {
 public:
  // seed: of the user.
  // place: identifies the cell by its position.
  // use, round, index: which stream of that cell.
  random_stream(std::uint64_t seed, std::uint64_t place, purpose use, std::uint64_t round = 0,
                std::uint64_t index = 0) noexcept {
    for (const std::uint64_t part : {seed, place, static_cast<std::uint64_t>(use), round, index})
      state_ = mix_bits(state_ + 0x9E3779B97F4A7C15ull + part);
  }

  // Returns 64 random bits.
  std::uint64_t bits() noexcept { return mix_bits(state_ += 0x9E3779B97F4A7C15ull); }

  // Returns a number that is uniform in [0, 1). It has 24 bits, so each value is exactly a float.
  float uniform() noexcept { return static_cast<float>(bits() >> 40) * 0x1p-24f; }

  // Returns a point that is uniform in a box.
  glm::vec3 in_box(const glm::vec3& min, const glm::vec3& max) noexcept {
    const float x = uniform(), y = uniform(), z = uniform();
    return min + (max - min) * glm::vec3{x, y, z};
  }

  // Returns a direction that is uniform on the unit sphere. Marsaglia's method (1972) needs only square roots, so each
  // machine computes the same bits.
  glm::vec3 on_sphere() noexcept {
    for (;;) {
      const float a = 2.0f * uniform() - 1.0f, b = 2.0f * uniform() - 1.0f, s = a * a + b * b;
      if (s >= 1.0f) continue;
      const float r = 2.0f * glm::sqrt(1.0f - s);
      return {a * r, b * r, 1.0f - 2.0f * s};
    }
  }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace sightcell::bake
