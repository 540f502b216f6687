#pragma once
// Players that walk about: a stand-in for a game. Each goes on from the view cell it is in to one beside it, for ever,
// in straight lines; what stands in a cell is no obstacle.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace relevance_server {

using place = std::array<float, 3>;

struct box {
  place min{}, max{};
};

// What others see of a player whose eye is there: 0.6 x 1.8 x 0.6 m.
box body_of(const place& eye);

// The same numbers on every machine, from a seed.
class random_numbers {
 public:
  explicit random_numbers(std::uint64_t seed) : state_(seed) {}
  std::uint32_t below(std::size_t count);  // count > 0
  float between(float low, float high);

 private:
  std::uint64_t next();
  std::uint64_t state_;
};

class crowd {
 public:
  // cells: at least one.
  crowd(std::vector<box> cells, std::uint32_t players, float meters_per_second, std::uint64_t seed);

  void walk(float seconds);
  std::span<const place> eyes() const { return eyes_; }

 private:
  struct path {
    std::uint32_t cell = 0;     // to which the player goes
    place door{}, end{};        // the way: to where both cells touch, then to a place in the new one
    bool through_door = false;  // the door is behind it
  };

  place inside(const box& where);
  void choose_way(path& p);
  void go(place& eye, path& p, float meters);

  std::vector<box> cells_;
  std::vector<std::vector<std::uint32_t>> beside_;  // by cell: those that share a face with it, or overlap
  float speed_;
  random_numbers random_;
  std::vector<place> eyes_;
  std::vector<path> paths_;
};

}  // namespace relevance_server
