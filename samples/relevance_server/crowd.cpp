#include "crowd.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relevance_server {
namespace {

constexpr float eye_over_floor = 1.65f, eye_below_top = 0.15f, half_width = 0.3f;  // meters
constexpr float narrowest_door = 0.3f;                                             // meters

box common(const box& a, const box& b) {
  box out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.min[axis] = std::max(a.min[axis], b.min[axis]);
    out.max[axis] = std::min(a.max[axis], b.max[axis]);
  }
  return out;
}

// A face or more, not an edge.
bool can_pass(const box& between) {
  int wide = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float width = between.max[axis] - between.min[axis];
    if (width < 0.0f) return false;
    wide += width >= narrowest_door ? 1 : 0;
  }
  return wide >= 2;
}

// Swept along x, so that a file of many cells takes no time.
std::vector<std::vector<std::uint32_t>> neighbors_of(const std::vector<box>& cells) {
  std::vector<std::uint32_t> order(cells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return cells[a].min[0] != cells[b].min[0] ? cells[a].min[0] < cells[b].min[0] : a < b;
  });
  std::vector<std::vector<std::uint32_t>> beside(cells.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t a = order[i];
    for (std::size_t k = i + 1; k < order.size() && cells[order[k]].min[0] <= cells[a].max[0]; ++k) {
      const std::uint32_t b = order[k];
      if (!can_pass(common(cells[a], cells[b]))) continue;
      beside[a].push_back(b);
      beside[b].push_back(a);
    }
  }
  return beside;
}

}  // namespace

box body_of(const place& eye) {
  return {{eye[0] - half_width, eye[1] - eye_over_floor, eye[2] - half_width},
          {eye[0] + half_width, eye[1] + eye_below_top, eye[2] + half_width}};
}

// SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t random_numbers::next() {
  std::uint64_t z = state_ += 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

std::uint32_t random_numbers::below(std::size_t count) {
  return static_cast<std::uint32_t>((next() >> 32) * count >> 32);
}

float random_numbers::between(float low, float high) {
  return low + (high - low) * (static_cast<float>(next() >> 40) / 16777216.0f);
}

crowd::crowd(std::vector<box> cells, std::uint32_t players, float meters_per_second, std::uint64_t seed)
    : cells_(std::move(cells)), beside_(neighbors_of(cells_)), speed_(meters_per_second), random_(seed) {
  for (std::uint32_t p = 0; p < players; ++p) {
    path way;
    way.cell = random_.below(cells_.size());
    eyes_.push_back(inside(cells_[way.cell]));
    choose_way(way);
    paths_.push_back(way);
  }
}

// Eyes are in the middle of a cell's height: nobody crawls, and nobody flies.
place crowd::inside(const box& where) {
  place out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out[axis] = axis == 1 ? 0.5f * (where.min[1] + where.max[1]) : random_.between(where.min[axis], where.max[axis]);
  }
  return out;
}

void crowd::choose_way(path& p) {
  const std::vector<std::uint32_t>& beside = beside_[p.cell];
  p.through_door = beside.empty();
  if (!beside.empty()) {
    const std::uint32_t next = beside[random_.below(beside.size())];
    p.door = inside(common(cells_[p.cell], cells_[next]));
    p.cell = next;
  }
  p.end = inside(cells_[p.cell]);
}

void crowd::go(place& eye, path& p, float meters) {
  while (meters > 0.0f) {
    const place& target = p.through_door ? p.end : p.door;
    const float x = target[0] - eye[0], y = target[1] - eye[1], z = target[2] - eye[2];
    const float distance = std::sqrt(x * x + y * y + z * z);
    if (distance > meters) {
      const float part = meters / distance;
      eye = {eye[0] + part * x, eye[1] + part * y, eye[2] + part * z};
      return;
    }
    eye = target;
    meters -= std::max(distance, 0.01f);  // two targets in the same place must not hold it for ever
    if (p.through_door) {
      choose_way(p);
    } else {
      p.through_door = true;
    }
  }
}

void crowd::walk(float seconds) {
  for (std::size_t i = 0; i < eyes_.size(); ++i) go(eyes_[i], paths_[i], speed_ * seconds);
}

}  // namespace relevance_server
