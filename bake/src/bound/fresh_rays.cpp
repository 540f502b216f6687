#include "bound/fresh_rays.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace sightcell::bake {
namespace {

constexpr std::uint64_t chunk_rays = 512;
// Where fewer than one place in 256 is free, a chunk casts fewer rays than asked rather than search on.
constexpr std::uint64_t max_places_per_ray = 256;

fresh_batch cast_chunk(const ray_scene& rays, const box& grown, float player_radius, std::uint64_t count,
                       const fresh_source& source, std::uint64_t chunk,
                       const std::function<bool(std::uint32_t)>& contains) {
  fresh_batch batch;
  random_stream random(source.seed, source.place, source.use, source.round, chunk);
  const auto eyes =
      draw_free_points(rays, grown, player_radius, count, count * max_places_per_ray, random, batch.places);
  sight seen;
  for (const glm::vec3& eye : eyes) {
    const glm::vec3 direction = random.on_sphere();
    rays.look(eye, direction, seen);
    const std::size_t before = batch.missed.size();
    if (seen.front != no_polygon && !contains(seen.front))
      batch.missed.push_back({seen.front, eye, seen.distance, direction});
    for (const std::uint32_t polygon : seen.before)
      if (!contains(polygon)) batch.missed.push_back({polygon, eye, seen.distance, direction});
    if (batch.missed.size() > before) ++batch.misses;
  }
  batch.rays = eyes.size();
  return batch;
}

}  // namespace

fresh_batch cast_fresh_rays(const ray_scene& rays, const box& grown, float player_radius, std::uint64_t count,
                            const fresh_source& source, const std::function<bool(std::uint32_t)>& contains) {
  std::vector<fresh_batch> chunks((count + chunk_rays - 1) / chunk_rays);
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
    const std::uint64_t size = std::min(chunk_rays, count - i * chunk_rays);
    chunks[i] = cast_chunk(rays, grown, player_radius, size, source, i, contains);
  });
  fresh_batch all;
  for (const fresh_batch& chunk : chunks) {
    all.rays += chunk.rays;
    all.misses += chunk.misses;
    all.places += chunk.places;
    all.missed.insert(all.missed.end(), chunk.missed.begin(), chunk.missed.end());
  }
  return all;
}

}  // namespace sightcell::bake
