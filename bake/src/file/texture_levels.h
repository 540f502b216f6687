#pragma once
// The finest mip level of each texture that a picture from a cell can need (docs/residency.md).
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// How many texels of a texture lie along a meter of a polygon: in the direction in which they are the most, and in the
// one at a right angle to it, in which they are the least.
struct texel_density {
  float most = 0.0f, least = 0.0f;
};

// Returns the density of a texture on a triangle in world space. texels: its texture coordinates, in texels. {0, 0},
// the density that needs the finest level at any distance, if the triangle has no area or a number is not finite.
texel_density density_of(const triangle& corners, const std::array<glm::dvec2, 3>& texels);

// Returns a lower bound of the texels of level 0 between two pixels that are 1 rad apart, for the level that a filter
// takes at any point of a polygon.
// distance: of the point to the eye is this, or more. Meters.
// height: of the eye above the plane of the polygon is this, or less; above 0. Meters.
// anisotropy: the largest one of the filter, 1 for none.
double texels_per_radian(const texel_density& density, double distance, double height, double anisotropy);

// Returns the number of the level (format/residency_table.h) for texels between two pixels, rounded to the finer side.
// texels: not negative; infinite for a texture that is not needed.
std::uint8_t level_number(double texels, std::uint8_t coarsest);

// Computes the levels of cells. Immutable; may be used from several threads.
class texture_levels {
 public:
  // s: with its textures. rays: of s; a part of the polygons may follow that are of another scene. Both must outlive
  // the object. player_radius: of valid viewpoints, meters. Memory: 8 bytes per polygon and texture of it.
  texture_levels(const scene::scene& s, const ray_scene& rays, float player_radius, double anisotropy);

  // Returns, for each texture, the fewest texels of level 0 between two pixels that are 1 rad apart, in any picture
  // from the region: a lower bound. Infinite for a texture that no polygon has which can face a viewpoint. polygons:
  // the source ids of the cell's set, ascending.
  std::vector<double> texels_of(const viewpoint_region& region, std::span<const std::uint32_t> polygons) const;

 private:
  // A draw with textures.
  struct textured_draw {
    std::uint32_t first = 0, count = 0;  // source ids
    std::size_t densities = 0;           // index of the first one; each polygon has one for each use
    std::span<const scene::texture_use> uses;
    bool moves = false;
  };

  void add_draw(const scene::scene& s, const scene::draw& d);
  void add_polygon(const textured_draw& draw, std::uint32_t polygon, const box& whole, std::span<const box> parts,
                   std::span<double> least) const;

  const ray_scene& rays_;
  double keep_off_, anisotropy_;
  std::size_t textures_;
  std::vector<textured_draw> draws_;  // ascending source ids
  std::vector<texel_density> densities_;
};

}  // namespace sightcell::bake
