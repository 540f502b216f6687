#pragma once
// Random numbers for tests that are the same on every machine. std::mt19937 is the same everywhere, but its result type
// may be wider, and the distributions of the standard library differ.
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>

namespace sightcell::test {

class random_source {
 public:
  using result_type = std::uint32_t;

  explicit random_source(std::uint32_t seed) : engine_(seed) {}
  result_type operator()() { return static_cast<result_type>(engine_()); }
  // From 0 to count - 1; and from 0 to below 1.
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>((std::uint64_t{(*this)()} * count) >> 32);
  }
  double share() { return (*this)() * 0x1p-32; }

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xFFFFFFFFu; }

 private:
  std::mt19937 engine_;
};

template <class Items>
void shuffle(random_source& random, Items& items) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random() % i]);
}

}  // namespace sightcell::test
