#pragma once
// The hemicubes of one cell as they are taken: counted, jittered, and what they see joins the cell's set.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>

#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "sightcell/base/random.h"
#include "sightcell/base/time_limit.h"

namespace sightcell::bake {

// What the importance of a hemicube is multiplied by (C in the thesis), before what it sees joins the set.
using importance_weight = std::function<double(const pose& where, const hemicube_view& view)>;

// How the hemicubes of a cell are taken, whoever says where.
struct hemicube_plan {
  std::uint32_t samples = 0;  // hemicubes, at most
  std::uint64_t seed = 0, place = 0;
  bool geometry_inside = false;
  double interior_share = 0.5;  // of the hemicubes, where geometry is inside: they become full cubes at interior points
  bool jitter = false;
  double seconds = 0.0;  // 0: no limit
};

// How many full cubes a plan has. One is two hemicubes back to back, so it counts as two samples.
std::uint32_t interior_cubes(const hemicube_plan& plan);

// Turned about its eye, so that no pixel's center moves by more than half a pixel of the front face's middle.
pose jittered(const pose& where, std::uint32_t resolution, random_stream random);

class hemicubes {
 public:
  // References must outlive the object. Time begins to count.
  hemicubes(const hemicube_plan& plan, hemicube_source& source, cell_set& set);

  std::uint32_t taken() const { return taken_; }
  std::uint32_t resolution() const { return source_.resolution(); }
  std::uint32_t left() const { return limit_.reached() ? 0 : plan_.samples - taken_; }

  // Renders them as one batch of the source, at most left() of them. Both spans have the same size. weigh: may be null.
  void take(std::span<const pose> poses, std::span<hemicube_view> views, const importance_weight& weigh = nullptr);
  // Full cubes at these points, as many as the plan has.
  void take_interior(std::span<const glm::vec3> points);

 private:
  const hemicube_plan& plan_;
  hemicube_source& source_;
  cell_set& set_;
  time_limit limit_;
  std::uint32_t taken_ = 0;
  std::vector<pose> turned_;
};

}  // namespace sightcell::bake
