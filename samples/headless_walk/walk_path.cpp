#include "walk_path.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace headless_walk {
namespace {

constexpr float eye_clearance = 0.05f;    // meters: as close to surfaces as the bake goes by default
constexpr float look_turn = 2.39996323f;  // radians, the golden angle: successive looks never repeat

glm::vec3 middle(const box& b) {
  return 0.5f * (b.min + b.max);
}

std::vector<box> nearest_next(std::vector<box> boxes) {
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    const glm::vec3 here = middle(boxes[i - 1]);
    const auto distance = [&](const box& b) { return glm::dot(middle(b) - here, middle(b) - here); };
    const auto rest = boxes.begin() + static_cast<std::ptrdiff_t>(i);
    std::iter_swap(rest, std::min_element(rest, boxes.end(),
                                          [&](const box& a, const box& b) { return distance(a) < distance(b); }));
  }
  return boxes;
}

}  // namespace

std::vector<step> make_path(const sightcell::scene::world_geometry& world, const std::vector<box>& boxes,
                            std::uint32_t frames, std::uint32_t& skipped) {
  const std::vector<box> tour = nearest_next(boxes);
  const std::size_t stops = std::min<std::size_t>(frames, tour.size());
  std::vector<glm::vec3> eyes;
  for (std::size_t i = 0; i < stops; ++i) {
    const box& stop = tour[i * tour.size() / stops];
    const auto place = stop.eye ? stop.eye : find_free_place(world, stop, eye_clearance);
    if (place) {
      eyes.push_back(*place);
    } else {
      ++skipped;
    }
  }
  std::vector<step> path;
  for (std::uint32_t f = 0; f < frames && !eyes.empty(); ++f) {
    const std::size_t at = std::size_t{f} * eyes.size() / frames;
    const std::size_t first_here = (at * frames + eyes.size() - 1) / eyes.size();
    glm::vec3 ahead = eyes[(at + 1) % eyes.size()] - eyes[at];
    ahead.y = 0.0f;  // people look along the floor
    float angle = look_turn * static_cast<float>(f - first_here);
    if (glm::dot(ahead, ahead) > 0.0f) angle += std::atan2(ahead.x, -ahead.z);
    path.push_back({eyes[at], {std::sin(angle), 0.0f, -std::cos(angle)}});
  }
  return path;
}

}  // namespace headless_walk
