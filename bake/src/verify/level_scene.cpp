#include "verify/level_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "input/joined_geometry.h"

namespace sightcell::bake {
namespace {

constexpr float never_begins = std::numeric_limits<float>::infinity();
constexpr std::uint32_t no_level = scene::no_index;

// Returns the distance at which a sphere has this coverage: its diameter by the height of the picture.
float distance_at(double coverage, float radius, double tangent) {
  return coverage > 0.0 ? static_cast<float>(radius / (coverage * tangent)) : never_begins;
}

}  // namespace

level_scene::level_scene(const scene::scene& s, const scene::world_geometry& world, const scene::object_levels& levels,
                         const stored_rules& rules, double fov)
    : geometry_(world), polygons_(s.polygon_count) {
  join(geometry_, scene::flatten(levels.coarser, rules.animated, rules.closed), s.name);
  places_.resize(geometry_.kinds.size());
  const double tangent = std::tan(fov * std::numbers::pi / 360.0);
  for (const scene::leveled_object& object : levels.objects)
    if (!object.finest.empty() && !object.coarser.empty()) add(s, object, tangent);
}

void level_scene::add(const scene::scene& s, const scene::leveled_object& given, double tangent) {
  switched_object added;
  added.draw = given.finest.front();
  const float radius = place_sphere(s, given.finest, added);
  const auto number = static_cast<std::uint32_t>(objects_.size());
  for (const std::uint32_t d : given.finest)
    for (std::uint32_t i = 0; i < s.draws[d].polygon_count; ++i) places_[s.draws[d].first_source + i] = {number, 0};
  for (const scene::object_level& level : given.coarser) {
    float begin = never_begins;
    if (level.begins.from_distance) begin = *level.begins.from_distance;
    if (level.begins.below_coverage) begin = distance_at(*level.begins.below_coverage, radius, tangent);
    without_switch_ += level.begins.from_distance || level.begins.below_coverage ? 0 : 1;
    added.begins.push_back(begin);
    const auto place = static_cast<std::uint32_t>(added.begins.size());
    for (std::uint32_t i = 0; i < level.polygons.count; ++i)
      places_[polygons_ + level.polygons.first + i] = {number, place};
  }
  added.end = distance_at(given.least_coverage, radius, tangent);
  level_count_ += static_cast<std::uint32_t>(added.begins.size());
  objects_.push_back(std::move(added));
}

// Places the center of the object at the center of the box of its polygons. Returns how far from it they reach.
float level_scene::place_sphere(const scene::scene& s, const std::vector<std::uint32_t>& draws,
                                switched_object& out) const {
  const auto for_each_corner = [&](const auto& use) {
    for (const std::uint32_t d : draws)
      for (std::uint32_t i = 0; i < s.draws[d].polygon_count; ++i) {
        const std::uint32_t polygon = s.draws[d].first_source + i;
        if (geometry_.kinds[polygon].absent) continue;
        for (std::size_t k = 0; k < 3; ++k) use(geometry_.positions[geometry_.indices[3 * std::size_t{polygon} + k]]);
      }
  };
  glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
  for_each_corner([&](const glm::vec3& corner) { low = glm::min(low, corner), high = glm::max(high, corner); });
  if (low.x > high.x) return 0.0f;
  out.center = 0.5f * low + 0.5f * high;
  float radius = 0.0f;
  for_each_corner([&](const glm::vec3& corner) { radius = std::max(radius, glm::distance(corner, out.center)); });
  return radius;
}

std::uint32_t level_scene::chosen(const switched_object& of, const glm::vec3& eye) {
  const float distance = glm::distance(eye, of.center);
  if (distance >= of.end) return no_level;
  for (std::size_t i = of.begins.size(); i > 0; --i)
    if (distance >= of.begins[i - 1]) return static_cast<std::uint32_t>(i);
  return 0;
}

void level_scene::find_visible(std::span<const std::uint8_t> has, std::vector<std::uint8_t>& visible) const {
  visible.assign(objects_.size(), 0);
  for (std::uint32_t polygon = 0; polygon < polygons_; ++polygon)
    if (has[polygon] && places_[polygon].object != scene::no_index) visible[places_[polygon].object] = 1;
}

}  // namespace sightcell::bake
