#include "bound/verification_rays.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "bound/ray_trial.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t chunk_rays = 512;
// If less than one point in 256 is valid, a chunk casts fewer rays than requested instead of searching on.
constexpr std::uint64_t most_tests_per_ray = 256;

verification_batch cast_chunk(const ray_scene& rays, const viewpoint_region& where, const visibility_rules& rules,
                              std::uint64_t count, const verification_stream& source, std::uint64_t chunk,
                              const std::function<bool(std::uint32_t)>& contains) {
  verification_batch batch;
  random_stream random(source.seed, source.place, source.use, source.round, chunk);
  const auto eyes = draw_viewpoints(rays, where, rules.player_radius, count, count * most_tests_per_ray, random,
                                    batch.viewpoints_tested);
  ray_trial one(rays, rules, contains);
  sight seen;
  for (const glm::vec3& eye : eyes) {
    const sight_line line{eye, rules.metric->direction(random)};
    rays.trace(line.eye, line.direction, seen);
    if (one.test(line, seen, random, batch.missed)) ++batch.misses;
  }
  batch.rays = eyes.size();
  batch.misses_of_volumes = one.misses_of_volumes();
  batch.missed_volumes = one.missed_volumes();
  return batch;
}

}  // namespace

verification_batch cast_verification_rays(const ray_scene& rays, const viewpoint_region& where,
                                          const visibility_rules& rules, std::uint64_t count,
                                          const verification_stream& source,
                                          const std::function<bool(std::uint32_t)>& contains,
                                          const std::function<bool()>& give_up) {
  std::vector<verification_batch> chunks((count + chunk_rays - 1) / chunk_rays);
  std::atomic<bool> given_up{false};
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
    if (give_up && (given_up || give_up())) {
      given_up = true;
      return;
    }
    const std::uint64_t size = std::min(chunk_rays, count - i * chunk_rays);
    chunks[i] = cast_chunk(rays, where, rules, size, source, i, contains);
  });
  verification_batch all;
  for (const verification_batch& chunk : chunks) {
    all.rays += chunk.rays;
    all.misses += chunk.misses;
    all.viewpoints_tested += chunk.viewpoints_tested;
    all.missed.insert(all.missed.end(), chunk.missed.begin(), chunk.missed.end());
    all.misses_of_volumes += chunk.misses_of_volumes;
    all.missed_volumes.insert(all.missed_volumes.end(), chunk.missed_volumes.begin(), chunk.missed_volumes.end());
  }
  all.given_up = given_up;
  if (given_up) all.rays = all.misses = all.misses_of_volumes = 0;
  return all;
}

}  // namespace sightcell::bake
