#pragma once
// Repeatable random numbers of 32 bits for tests: std::mt19937 gives the same numbers everywhere, but in a wider type.
#include <cstdint>
#include <random>

namespace sightcell::test {

class random_source {
 public:
  using result_type = std::uint32_t;

  explicit random_source(std::uint32_t seed) : engine_(seed) {}
  result_type operator()() { return static_cast<result_type>(engine_()); }
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xFFFFFFFFu; }

 private:
  std::mt19937 engine_;
};

}  // namespace sightcell::test
