#pragma once
// How much of all that is seen from a cell each polygon covers, and the class that a file gives it for that.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Class k, 0 .. 10, has the visible solid angles of 2 pi / 4^(k + 1) sr up to four times that. The last one has all
// smaller ones, of about a pixel of 1920 x 1080 at 60 degrees or less: which of these comes first is half of all bits
// and shows nowhere. What is no number is of it too.
std::uint8_t importance_class_of(double visible_sr);

// Of one cell. Const functions may be called from any thread.
class importance_meter {
 public:
  // grown: the cell's box with the margin. Random numbers come from seed, the cell's box and the corners of a polygon;
  // so the answers do not depend on ids, order or threads.
  importance_meter(const ray_scene& rays, const box& grown, float player_radius, std::uint64_t seed);

  // What rays need from one polygon to the next; one thread's.
  struct scratch {
    std::vector<sight_line> lines;
    std::vector<float> lengths;
    std::vector<double> angles;
    std::vector<sight> sights;
    std::vector<std::uint32_t> coincident;
  };

  // The solid angle of what is seen of the polygon, in the mean over the free places of the grown box, sr; 0 where no
  // ray has seen it. That may be a polygon of which little is seen, but not much in the mean: rays go on until half a
  // hit among them would be a solid angle of the last class, 256 at most.
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
