#pragma once
// Pixels of a hemicube source against those of rays: how many differ, and whether rule 2 of seeing or an edge through
// the pixel's center says why.
#include <cmath>
#include <cstdint>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "trace/ray_scene.h"

namespace sightcell::test {

// Counts of pixels. A pixel that differs is of one of three kinds.
struct agreement {
  std::uint64_t pixels = 0;
  std::uint64_t different = 0;   // its polygon is not that of the rays; nothing is a polygon here
  std::uint64_t coincident = 0;  // the two lie in the same place along the pixel's ray (rule 2)
  // A ray 1/100 pixel or less beside the center sees what the source says; or, for polygons that are thinner, the
  // nearer of the two has its outline there and the other one is behind it.
  std::uint64_t at_edge = 0;
  std::uint64_t depths = 0;  // not counted as different: the same polygon, 1/depth by more than 0.1 % another

  std::uint64_t wrong() const { return different - coincident; }
  std::uint64_t elsewhere() const { return different - coincident - at_edge; }
  double share() const { return pixels == 0 ? 0.0 : static_cast<double>(wrong()) / static_cast<double>(pixels); }
  void add(const agreement& other);
};

// A pixel whose difference nothing explains.
struct odd_pixel {
  bake::pose from;
  std::uint32_t pixel = 0;
  std::uint32_t of_rays = 0, of_source = 0;  // scene::no_index: nothing
  float depth_of_rays = 0.0f, depth_of_source = 0.0f;
  double beside = 0.0;  // pixels from the center to where rays see what the source says; infinite: not within two
  double outline_of_rays = INFINITY, outline_of_source = INFINITY;  // from the center to the polygons' outlines, pixels
};

// Adds unexplained pixels to odd, up to 1000.
agreement compare(const bake::ray_scene& rays, const bake::pose& from, const bake::hemicube_image& of_rays,
                  const bake::hemicube_image& of_source, std::vector<odd_pixel>& odd);

}  // namespace sightcell::test
