#pragma once
// Measures how large a part of the view from a cell each polygon covers, and maps it to the classes of a file.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Returns the importance class of a visible solid angle in sr. Class k, 0 .. 10, begins at 2 pi / 4^(k + 1) sr and
// ends at four times that. The last class has all smaller solid angles, about a pixel of 1920 x 1080 at 60 degrees or
// less: their order would take half of all bits and has no visible effect. NaN is in the last class too.
std::uint8_t importance_class_of(double visible_sr);

// Measures polygons from one cell. Const functions may be called from any thread.
class importance_meter {
 public:
  // grown: the box of the cell with the margin.
  // seed: random numbers depend on it, the cell's box and the corners of a polygon, so results do not depend on ids,
  // order or threads.
  importance_meter(const ray_scene& rays, const box& grown, float player_radius, std::uint64_t seed);

  // Storage that is reused from one polygon to the next, for one thread.
  struct scratch {
    std::vector<sight_line> lines;
    std::vector<float> lengths;
    std::vector<double> angles;
    std::vector<sight> sights;
    std::vector<std::uint32_t> coincident;
  };

  // Returns the mean visible solid angle of the polygon over the valid viewpoints of the grown box, in sr; 0 if no
  // ray hit it. Rays are cast, up to 256, until an expected half hit among them would be a solid angle of the last
  // class. So a polygon with the result 0 may be visible, but its mean is small.
  double visible_angle(std::uint32_t polygon, scratch& room) const;

 private:
  std::uint32_t cast(std::uint32_t polygon, std::size_t first_eye, std::uint32_t begin, random_stream& random,
                     scratch& room, double& whole, double& seen) const;
  bool sees(const sight_line& line, const sight& what, float length, std::uint32_t polygon,
            std::vector<std::uint32_t>& coincident) const;

  const ray_scene& rays_;
  std::uint64_t seed_, place_;
  std::vector<glm::vec3> eyes_;
};

}  // namespace sightcell::bake
