#pragma once
// Measures the miss probability of what a host draws with levels of detail in clusters (docs/meshlets.md): rays hit the
// cut that it draws, and the sets of the file decide which clusters of the cut it draws. verify.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/verify.h"

namespace sightcell::bake {

// The cut: the coarsest clusters whose error, as the camera sees it, is not above a number of pixels.
struct cut_settings {
  std::vector<double> pixels = {1.0};  // --cut: each 0 or more; 0 draws the surfaces of the scene
  std::uint32_t rows = 1080;           // --cut-rows: of the picture
  double fov = 60.0;                   // --cut-fov: vertical field of view, degrees
};

// Why a ray shows a cluster of the whole cut that the host does not draw.
enum class cut_miss : std::uint8_t {
  of_set,     // the ray is a miss without levels too
  at_coarse,  // a coarse cluster, where level 0 blocks the ray or in front of that: the set has no leaf below it
  revealed    // a cluster behind the polygon of level 0 that blocks the ray: the cut covers less
};

// A cluster of a cut that rays hit and that is not visible by the set of a cell.
struct missing_cluster {
  cut_miss kind = cut_miss::of_set;
  std::uint32_t cell = 0;
  std::uint32_t draw = 0;         // in scene::draws
  std::uint32_t cluster = 0;      // of the draw: its leaves first, then coarser ones
  bool leaf = false;              // it has polygons of the scene
  std::uint64_t rays = 0;         // how many rays hit it first
  std::array<float, 3> eye{};     // the viewpoint of the first of them
  std::array<float, 3> target{};  // where that ray hit
};

// Result for one number of pixels.
struct cut_verification {
  double pixels = 0.0;
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;            // rays whose first cluster in the whole cut is not visible
  std::uint64_t misses_of_leaves = 0;  // of misses: that cluster has polygons of the scene
  std::uint64_t misses_of_set = 0, misses_at_coarse = 0, misses_revealed = 0;  // misses by kind
  // Rays that are no misses because they pass a gap of level 0 narrower than the light-leak tolerance. Openings of the
  // cut never excuse a ray.
  std::uint64_t rays_in_gaps = 0;
  // Rays that pass the whole cut where level 0 blocks them, by more than the error along the ray. Those that show what
  // the sets lack are misses too. Beyond the error: no polygon of the cut is within its error of where level 0 blocks
  // the ray.
  std::uint64_t rays_opened = 0, rays_opened_beyond_error = 0;
  double pixel_error = 0.0;  // misses / rays
  double upper_bound = 1.0;  // of the error over all cells, one-sided Clopper-Pearson
  double confidence = 0.95;  // of all upper bounds
  std::vector<cell_verification> cells;
  std::vector<missing_cluster> missing;  // at most 100, those with the most rays first

  // Of the scene: clusters of its polygons, and coarser ones.
  std::uint32_t leaf_clusters = 0, coarse_clusters = 0;
  // Means over cells, of a cut from a viewpoint of the cell: all of it, and what of it is visible.
  double cut_clusters = 0.0, cut_triangles = 0.0;
  double drawn_clusters = 0.0, drawn_triangles = 0.0;
  // Means over cells, of a host without levels: visible clusters of polygons of the scene, their polygons, and the
  // polygons of the set.
  double set_clusters = 0.0, set_cluster_polygons = 0.0, set_polygons = 0.0;
};

// Measures a file for each number of pixels. s, file, name, how, on_progress: as for verify(); how.metric must be
// metric_kind::pixel, and how.cells_from null. Fails with settings.out-of-range for cut, and as verify(). Cost: twice
// that of verify() for each number of pixels, the levels of all primitives, and memory for about as many polygons
// again.
std::vector<cut_verification> verify_cut(const scene::scene& s, std::span<const std::byte> file,
                                         const std::string& name, const verify_settings& how, const cut_settings& cut,
                                         const verify_progress& on_progress);

}  // namespace sightcell::bake
