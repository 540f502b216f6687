#pragma once
// Measures the miss probability of what a host draws with levels of detail of objects (docs/levels.md): each object is
// drawn with the level that its distance from the viewpoint chooses, where the set of the cell has any polygon of its
// level 0. verify.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/verify.h"

namespace sightcell::scene {
struct object_levels;  // sightcell/scene/object_levels.h
}

namespace sightcell::bake {

// What a ray met that the host does not draw.
enum class level_miss : std::uint8_t {
  of_set,    // the ray is a miss without coarser levels too
  at_level,  // a coarser level of an object of which the set has no polygon
  revealed   // a polygon of the scene that shows because the coarser level of another object covers less
};

// What rays met that the host does not draw.
struct missing_at_levels {
  level_miss kind = level_miss::of_set;
  std::uint32_t cell = 0;
  std::uint32_t draw = 0;         // of level 0, in scene::draws
  std::uint32_t level = 0;        // the coarser level that was hit; 0: a polygon of the scene
  std::uint32_t polygon = 0;      // source id; 0xFFFFFFFF for a coarser level
  std::uint32_t before = 0;       // draw that the ray hits first without coarser levels; 0xFFFFFFFF: none
  std::uint64_t rays = 0;         // how many rays met it
  std::array<float, 3> eye{};     // the viewpoint of the first of them
  std::array<float, 3> target{};  // where that ray hit
};

struct level_verification {
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;
  std::uint64_t misses_of_set = 0, misses_at_levels = 0, misses_revealed = 0;  // misses by kind
  std::uint64_t rays_at_levels = 0;                                            // rays that hit a coarser level
  double pixel_error = 0.0;                                                    // misses / rays
  double upper_bound = 1.0;  // of the error over all cells, one-sided Clopper-Pearson
  double confidence = 0.95;  // of all upper bounds
  std::vector<cell_verification> cells;
  std::vector<missing_at_levels> missing;  // at most 100, those with the most rays first

  std::uint32_t objects = 0, levels = 0;    // objects with coarser levels, and these
  std::uint32_t levels_without_switch = 0;  // of levels: those that are never drawn
};

// Measures a file. s, file, name, how, on_progress: as for verify(); how.metric must be metric_kind::pixel, and
// how.cells_from null.
// levels: of the same file as s.
// fov: --levels-fov: vertical field of view of the picture, degrees above 0 and below 180.
// Fails with settings.out-of-range for fov, scene.no-levels if no object has a level that can be drawn, and as
// verify(). Cost: that of verify(), and memory for the polygons of all coarser levels.
level_verification verify_levels(const scene::scene& s, const scene::object_levels& levels,
                                 std::span<const std::byte> file, const std::string& name, const verify_settings& how,
                                 double fov, const verify_progress& on_progress);

}  // namespace sightcell::bake
