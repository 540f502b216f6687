#include "volumes/stored_volumes.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "sightcell/base/random.h"

namespace sightcell::bake {

std::size_t stored_volumes::place_hash::operator()(const glm::ivec3& place) const {
  std::uint64_t h = 0;
  for (glm::length_t i = 0; i < 3; ++i) h = mix_bits(h + static_cast<std::uint32_t>(place[i]));
  return h;
}

stored_volumes::stored_volumes(const format::lattice_shape& shape, std::span<const format::lattice_place> places)
    : size_(shape.width, shape.height, shape.width),
      min_(std::numeric_limits<double>::infinity()),
      max_(-std::numeric_limits<double>::infinity()) {
  numbers_.reserve(places.size());
  for (std::uint32_t number = 0; number < places.size(); ++number) {
    const glm::ivec3 place(places[number].x, places[number].y, places[number].z);
    numbers_.emplace(place, number);
    min_ = glm::min(min_, glm::dvec3(place) * size_);
    max_ = glm::max(max_, (glm::dvec3(place) + 1.0) * size_);
  }
}

void stored_volumes::passed(const sight_line& line, double to, std::vector<passed_volume>& out) const {
  out.clear();
  const glm::dvec3 from(line.eye), along(line.direction);
  double here = 0.0, end = to;
  for (glm::length_t i = 0; i < 3; ++i) {
    if (along[i] == 0.0) {
      if (from[i] < min_[i] || from[i] >= max_[i]) return;
      continue;
    }
    const double a = (min_[i] - from[i]) / along[i], b = (max_[i] - from[i]) / along[i];
    here = std::max(here, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  while (here < end) {
    double next = end;
    for (glm::length_t i = 0; i < 3; ++i) {
      if (along[i] == 0.0) continue;
      const double at = (from[i] + along[i] * here) / size_[i], step = along[i] > 0.0 ? 1.0 : -1.0;
      double border = along[i] > 0.0 ? std::floor(at) : std::ceil(at), when = here;
      do {
        border += step;
        when = (border * size_[i] - from[i]) / along[i];
      } while (!(when > here));  // by rounding, the border may be the current one
      next = std::min(next, when);
    }
    const glm::ivec3 place(glm::floor((from + along * (0.5 * (here + next))) / size_));
    if (const auto found = numbers_.find(place); found != numbers_.end())
      out.push_back({found->second, static_cast<float>(here)});
    here = next;
  }
}

bool stored_trial::lacks(const sight_line& line, double to) const {
  thread_local std::vector<passed_volume> passed;
  lacking(line, to, passed);
  return !passed.empty();
}

void stored_trial::lacking(const sight_line& line, double to, std::vector<passed_volume>& out) const {
  volumes_.passed(line, to, out);
  std::erase_if(out, [&](const passed_volume& p) { return contains_(p.volume); });
}

}  // namespace sightcell::bake
