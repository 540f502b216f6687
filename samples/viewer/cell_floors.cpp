#include "cell_floors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace viewer {
namespace {

constexpr float same_floor = 2.0f;  // meters between the bottoms of neighbors
constexpr float touching = 0.01f;
constexpr float overlap = 0.05f;  // meters: less is a rounded border
constexpr std::size_t most_floors = 12;

// Calls f(a, b) for each pair of cells that are nearer than `gap` in plan; less than 0 for those that overlap.
template <class F>
void for_pairs_in_plan(std::span<const cell> cells, float gap, const F& f) {
  std::vector<std::uint32_t> by_x(cells.size());
  std::iota(by_x.begin(), by_x.end(), 0u);
  std::sort(by_x.begin(), by_x.end(),
            [&](std::uint32_t a, std::uint32_t b) { return cells[a].min.x < cells[b].min.x; });
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const cell& a = cells[by_x[i]];
    for (std::size_t k = i + 1; k < by_x.size() && cells[by_x[k]].min.x < a.max.x + gap; ++k) {
      const cell& b = cells[by_x[k]];
      if (b.min.z < a.max.z + gap && a.min.z < b.max.z + gap) f(by_x[i], by_x[k]);
    }
  }
}

class joined {
 public:
  explicit joined(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t of) {
    while (parent_[of] != of) of = parent_[of] = parent_[parent_[of]];
    return of;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

map_floor& add(map_floor& floor, const map_floor& other) {
  floor.cells.insert(floor.cells.end(), other.cells.begin(), other.cells.end());
  floor.lowest = std::min(floor.lowest, other.lowest);
  floor.highest = std::max(floor.highest, other.highest);
  return floor;
}

}  // namespace

std::vector<map_floor> floors_of(std::span<const cell> cells) {
  joined parts(cells.size());
  for_pairs_in_plan(cells, touching, [&](std::uint32_t a, std::uint32_t b) {
    if (std::abs(cells[a].min.y - cells[b].min.y) < same_floor) parts.join(a, b);
  });
  std::vector<map_floor> found(cells.size());
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    map_floor& part = found[parts.root(i)];
    const map_floor one{{i}, cells[i].min.y, cells[i].min.y};
    part.cells.empty() ? part = one : add(part, one);
  }
  // Which parts lie over each other: by their roots.
  std::vector<std::vector<std::uint32_t>> over(cells.size());
  for_pairs_in_plan(cells, -overlap, [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t x = parts.root(a), y = parts.root(b);
    if (x == y) return;
    over[x].push_back(y);
    over[y].push_back(x);
  });
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    if (!found[i].cells.empty()) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return found[a].lowest < found[b].lowest; });
  std::vector<map_floor> floors;
  std::vector<std::size_t> floor_of(cells.size(), most_floors);
  for (const std::uint32_t part : order) {
    std::size_t number = 0;  // above all that it lies over
    for (const std::uint32_t other : over[part]) {
      if (floor_of[other] < most_floors) number = std::max(number, floor_of[other] + 1);
    }
    number = std::min({number, floors.size(), most_floors - 1});
    floor_of[part] = number;
    number == floors.size() ? (void)floors.emplace_back(found[part]) : (void)add(floors[number], found[part]);
  }
  return floors;
}

std::array<float, 3> heat_color(float share) {
  constexpr std::array<std::array<float, 3>, 5> stops{{{0.16f, 0.36f, 0.75f},
                                                       {0.15f, 0.65f, 0.65f},
                                                       {0.45f, 0.75f, 0.30f},
                                                       {0.95f, 0.75f, 0.20f},
                                                       {0.85f, 0.22f, 0.15f}}};
  const float at = std::clamp(share, 0.0f, 1.0f) * (stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const float part = at - static_cast<float>(low);
  std::array<float, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = stops[low][i] + part * (stops[low + 1][i] - stops[low][i]);
  return out;
}

}  // namespace viewer
