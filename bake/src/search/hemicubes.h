#pragma once
// Renders the hemicubes of one cell: counts and jitters them and adds what they show to the cell's set.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "sightcell/base/random.h"
#include "sightcell/base/time_limit.h"

namespace sightcell::bake {

// Returns the factor by which the importance of a hemicube is multiplied before it is used (C in the thesis).
using importance_weight = std::function<double(const pose& where, const hemicube_view& view)>;

// How many hemicubes a cell gets, and how they are rendered. The sampler chooses their poses.
struct hemicube_plan {
  std::uint32_t samples = 0;  // limit
  std::uint64_t seed = 0, place = 0;
  bool geometry_inside = false;
  // Share of hemicubes that form full cubes at interior points, if there is geometry inside.
  double interior_share = 0.5;
  bool jitter = false;
  const time_limit* limit = nullptr;  // null: none
};

// Returns the number of full cubes of a plan. A full cube is two hemicubes back to back and counts as two samples.
std::uint32_t interior_cubes(const hemicube_plan& plan);

// Returns the pose turned about its eye by a random angle, so that no pixel's center moves by more than half the width
// of a pixel in the middle of the front face.
pose jittered(const pose& where, std::uint32_t resolution, random_stream random);

// Appends the two hemicubes, back to back, of a full cube at this viewpoint.
void add_cube(const glm::vec3& eye, std::vector<pose>& poses);

// Renders the hemicubes of one cell.
class hemicubes {
 public:
  // References must outlive the object.
  hemicubes(const hemicube_plan& plan, hemicube_source& source, cell_set& set);

  std::uint32_t taken() const { return taken_; }
  std::uint32_t resolution() const { return source_.resolution(); }
  // Returns the number of hemicubes that may still be rendered; 0 after the time limit.
  std::uint32_t left() const { return plan_.limit && plan_.limit->reached() ? 0 : plan_.samples - taken_; }

  // Renders the poses as one batch, up to left() of them, and adds what they show to the set.
  // poses, views: of the same size; views are overwritten.
  // weigh: may be null.
  void take(std::span<const pose> poses, std::span<hemicube_view> views, const importance_weight& weigh = nullptr);
  // Renders full cubes at these points, up to the number that the plan has.
  void take_interior(std::span<const glm::vec3> points);

 private:
  const hemicube_plan& plan_;
  hemicube_source& source_;
  cell_set& set_;
  std::uint32_t taken_ = 0;
  std::vector<pose> turned_;
};

}  // namespace sightcell::bake
