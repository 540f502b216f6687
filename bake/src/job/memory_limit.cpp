#include "job/memory_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <glm/vec3.hpp>
#include <string>

#include "search/near_polygons.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

// Bytes per polygon, measured on scenes of 100,000 to 7.9 million polygons (tests/bench/bench_stages.cpp) and rounded
// upwards.
constexpr std::uint64_t of_polygon = 13;     // its corners and its kind; those of its vertices are counted
constexpr std::uint64_t of_rays = 220;       // two trees of Embree's while they are built
constexpr std::uint64_t of_masked = 400;     // with an alpha test: trees of its parts, and one of whole polygons
constexpr std::uint64_t of_neighbors = 48;   // lists of polygons with common vertices and of coincident polygons
constexpr std::uint64_t of_source = 112;     // clusters of the rasterizer while they are built; OpenGL takes the same
constexpr std::uint64_t of_duplicates = 16;  // while duplicates are searched for
constexpr std::uint64_t of_shadows = 16;     // where the shadow of each falls, for one sun at a time
constexpr std::uint64_t of_workplace = 9;    // pixels of each polygon in a hemicube

constexpr std::uint64_t vertex_bytes = 12;
// A column of the height field for the search of floors (cells/voxel_field.cpp). Four columns along a meter, up to
// 4,194,304 in all.
constexpr std::uint64_t of_column = 40;
constexpr double most_columns = 4 << 20, columns_per_square_meter = 16.0;
// The hits of a wave of rays with their order, and the seed rays by polygon (sampler/guided_search.cpp).
constexpr std::uint64_t of_wave = 65536 * 128ull;
constexpr std::uint64_t of_seed_ray = 28;
// Libraries, their workers and what the allocator keeps for each thread.
constexpr std::uint64_t of_process = 32ull << 20;
// Records of neighbors and of cells that wait to be committed.
constexpr std::uint64_t of_records = 8ull << 20;

std::uint64_t from_status(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field)) return std::stoull(line.substr(field.size())) * 1024;
  return 0;
}

std::string text(std::uint64_t bytes) {
  return bytes < (1ull << 30) ? fmt::format("{} MiB", (bytes + (1u << 20) - 1) >> 20)
                              : fmt::format("{:.1f} GiB", static_cast<double>(bytes) / (1ull << 30));
}

std::uint64_t flattened(const scene::scene& s) {
  std::uint64_t vertices = 0;
  for (const scene::draw& d : s.draws) vertices += s.geometries[d.geometry].positions.size();
  return vertices * vertex_bytes + s.polygon_count * of_polygon;
}

std::uint64_t polygons_with_mask(const scene::scene& s) {
  std::uint64_t polygons = 0;
  for (const scene::draw& d : s.draws)
    if (d.material != scene::no_index && s.materials[d.material].alpha == scene::alpha_mode::mask)
      polygons += d.polygon_count;
  return polygons;
}

}  // namespace

std::uint64_t resident_memory() {
  return from_status("VmRSS:");
}

std::uint64_t peak_resident_memory() {
  return from_status("VmHWM:");
}

std::uint64_t memory_of_scene(const scene::scene& s, const settings& how) {
  std::uint64_t per_polygon = of_rays + of_duplicates;
  if (needs_neighbors(how)) per_polygon += of_neighbors;
  if (takes_hemicubes(how.sampler) && how.source != "rays") per_polygon += of_source;
  if (!how.suns.empty()) per_polygon += of_shadows;
  const std::uint64_t copies = how.all_double_sided ? 2 : 1;
  std::uint64_t bytes = of_process;
  for (const scene::scene* one : {&s, how.cells_from})
    if (one != nullptr)
      bytes += copies * flattened(*one) + one->polygon_count * per_polygon + polygons_with_mask(*one) * of_masked;
  return bytes;
}

std::uint64_t memory_of_worker(std::uint64_t polygons, std::uint64_t set_bytes, const settings& how) {
  if (!takes_hemicubes(how.sampler)) return set_bytes + polygons * of_seed_ray + of_wave + of_records;
  // Depths and ids of one face. The rays source keeps hits of all five faces with their positions, which is more.
  const std::uint64_t pixels = std::uint64_t{how.resolution} * how.resolution;
  const std::uint64_t of_images = how.source == "rays" ? 64 * pixels : 16 * pixels;
  return set_bytes + polygons * of_workplace + of_images + of_records;
}

std::uint64_t memory_of_floors(double width, double depth, const settings& how) {
  if (how.cells_file || how.cells_grid || !how.cells.empty() || how.reach == reach_kind::none) return 0;
  const double columns = std::min(width * depth * columns_per_square_meter, most_columns);
  return of_column * static_cast<std::uint64_t>(std::max(columns, 0.0));
}

void require_memory(const scene::scene& s, const settings& how, const scene::world_geometry* flattened_scene) {
  if (how.memory == 0) return;
  std::uint64_t polygons = s.polygon_count;
  if (how.cells_from != nullptr) polygons += how.cells_from->polygon_count;
  // A set is 8 bytes per polygon.
  std::uint64_t needed = resident_memory() + memory_of_scene(s, how) + memory_of_worker(polygons, 8 * polygons, how);
  if (flattened_scene != nullptr) {
    const glm::vec3 size = flattened_scene->max - flattened_scene->min;
    needed += memory_of_floors(static_cast<double>(size.x), static_cast<double>(size.z), how);
    needed -=
        std::min(needed, flattened(s) + (how.cells_from ? flattened(*how.cells_from) : 0));  // it is resident already
  }
  const std::uint64_t so_far = peak_resident_memory();
  if (std::max(needed, so_far) <= how.memory) return;
  throw error(error_kind::failed, "bake.memory", s.name,
              fmt::format("needs about {} with {} polygons{}; --memory is {}", text(std::max(needed, so_far)), polygons,
                          so_far > how.memory ? fmt::format(", {} to load", text(so_far)) : "", text(how.memory)),
              "give a larger --memory, or bake the scene in parts");
}

std::size_t workers_that_fit(std::size_t workers, std::uint64_t worker_bytes, const settings& how) {
  if (how.memory == 0) return workers;
  const std::uint64_t taken = resident_memory();
  const std::uint64_t left = how.memory > taken ? how.memory - taken : 0;
  return std::clamp<std::size_t>(left / std::max<std::uint64_t>(worker_bytes, 1), 1, std::max<std::size_t>(workers, 1));
}

}  // namespace sightcell::bake
