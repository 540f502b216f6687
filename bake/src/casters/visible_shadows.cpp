#include "casters/visible_shadows.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <utility>

#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t polygons_per_try = 16384;
constexpr std::uint64_t first_part = 1ull << 34;  // of the random numbers: beyond the parts of a batch
// Cosine: where the light grazes a receiver, shadows are left to random rays.
constexpr float least_slope = 0.05f;
constexpr float sphere = 12.566371f;  // sr

// The view of a shadow from one viewpoint.
struct glance {
  sight_line line;
  float distance = 0.0f;
  float share = 0.0f;  // of the directions of all glances together, filled by the shadow if nothing is in front
};

// Tries the polygons of one part.
class polygon_trial {
 public:
  polygon_trial(const ray_scene& rays, const polygon_shadows& shadows, const caster_sets& sets,
                std::span<const glm::vec3> eyes, double least_share)
      : rays_(rays), shadows_(shadows), sets_(sets), eyes_(eyes), least_share_(static_cast<float>(least_share)) {}

  void try_polygon(std::uint32_t polygon, random_stream& random) {
    const triangle t = corners_of(rays_.geometry(), polygon);
    const float across = 0.5f * std::abs(glm::dot(glm::cross(t[1] - t[0], t[2] - t[0]), shadows_.to_light));
    for (std::size_t i = 0; i < shadow_points; ++i) {
      const std::uint32_t receiver = shadows_.receivers[shadow_points * polygon + i];
      if (receiver == no_polygon || !sets_.camera(receiver)) continue;
      if (try_point(shadow_point(rays_.geometry(), polygon, i), receiver, across / shadow_points, random)) return;
    }
  }

  std::uint64_t rays_cast() const { return cast_; }
  std::vector<missed_shadow>& missed() { return missed_; }

 private:
  using glances = std::array<glance, 8>;

  // across: area around the point of the caster, projected along the light.
  // Most points end at the estimate, before any ray is cast. Returns whether a shadow is missing.
  bool try_point(const glm::vec3& caster, std::uint32_t receiver, float across, random_stream& random) {
    const triangle t = corners_of(rays_.geometry(), receiver);
    const glm::vec3 cross = glm::cross(t[1] - t[0], t[2] - t[0]);
    const float length = glm::length(cross), slope = glm::dot(cross, shadows_.to_light);
    if (!(length > 0.0f) || std::abs(slope) < least_slope * length) return false;
    const glm::vec3 point = caster - glm::dot(caster - t[0], cross) / slope * shadows_.to_light;
    glances from;
    if (draw_glances(point, cross / length, across * length / std::abs(slope), random, from) < least_share_)
      return false;
    ++cast_;
    const shadow_line up = shadow_line_of(point, from[0].distance, shadows_.to_light, receiver);
    return find_lacking(rays_, up, sets_.drawn, lacking_) && is_missing(from, receiver);
  }

  // Draws viewpoints for a shadow of this area on a plane of this normal. Returns the sum of the shares.
  float draw_glances(const glm::vec3& point, const glm::vec3& normal, float area, random_stream& random,
                     glances& from) const {
    float sum = 0.0f;
    for (glance& one : from) {
      one.line.eye = eyes_[random.bits() % eyes_.size()];
      one.distance = std::max(glm::length(point - one.line.eye), 1e-3f);
      one.line.direction = (point - one.line.eye) / one.distance;
      const float fills = area * std::abs(glm::dot(normal, one.line.direction)) / (one.distance * one.distance);
      one.share = std::min(fills / sphere, 0.5f) / static_cast<float>(from.size());
      sum += one.share;
    }
    return sum;
  }

  // Looks from the largest shares on, until those that show the receiver suffice or the rest cannot.
  bool is_missing(glances& from, std::uint32_t receiver) {
    std::sort(from.begin(), from.end(), [](const glance& a, const glance& b) { return a.share > b.share; });
    float shown = 0.0f, left = 0.0f;
    for (const glance& one : from) left += one.share;
    for (const glance& one : from) {
      if (shown + left < least_share_) return false;
      left -= one.share;
      ++cast_;
      rays_.trace(one.line.eye, one.line.direction, seen_);
      if (seen_.front != receiver || seen_.distance < 0.99f * one.distance) continue;
      shown += one.share;
      if (shown >= least_share_) return lacks_shadow(rays_, one.line, seen_, shadows_.to_light, sets_, missed_);
    }
    return false;
  }

  const ray_scene& rays_;
  const polygon_shadows& shadows_;
  const caster_sets& sets_;
  const std::span<const glm::vec3> eyes_;
  const float least_share_;
  std::uint64_t cast_ = 0;
  std::vector<missed_shadow> missed_;
  sight seen_;
  lacking_casters lacking_;
};

}  // namespace

std::vector<missed_shadow> missed_shadows_of_polygons(const ray_scene& rays, const polygon_shadows& shadows,
                                                      const caster_sets& sets, std::span<const glm::vec3> eyes,
                                                      const verification_stream& numbers, double least_share,
                                                      std::uint64_t& rays_cast) {
  const std::size_t polygons = shadows.receivers.size() / shadow_points;
  std::vector<polygon_trial> parts((polygons + polygons_per_try - 1) / polygons_per_try,
                                   {rays, shadows, sets, eyes, least_share});
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    random_stream random(numbers.seed, numbers.place, numbers.use, numbers.round, first_part + part);
    const std::size_t end = std::min((part + 1) * polygons_per_try, polygons);
    for (std::size_t i = part * polygons_per_try; i < end; ++i) {
      const auto polygon = static_cast<std::uint32_t>(i);
      if (sets.drawn(polygon)) continue;
      parts[part].try_polygon(polygon, random);
    }
  });
  std::vector<missed_shadow> missed;
  for (polygon_trial& part : parts) {
    rays_cast += part.rays_cast();
    std::move(part.missed().begin(), part.missed().end(), std::back_inserter(missed));
  }
  return missed;
}

}  // namespace sightcell::bake
