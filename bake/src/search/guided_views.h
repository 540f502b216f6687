#pragma once
// Chooses the poses of the sampler `guided`: spread evenly over the faces of the cell and, if there is geometry
// inside, over its volume, for any number of hemicubes.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "search/boundary_face.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// The parameters of guided_views for one cell.
struct guided_settings {
  std::uint64_t seed = 0, place = 0;
  float player_radius = 0.05f;  // meters
  bool geometry_inside = false;
  // Share of hemicubes that form full cubes inside, two per cube, if there is geometry inside.
  double interior_share = 0.25;
  std::uint32_t resolution = 256;
  std::uint32_t taken = 0;  // hemicubes rendered in this cell before; the sequence continues after them
};

// A Halton sequence per face in bases 2 and 3, inside the cell in bases 2, 3 and 5, with a random shift (Cranley and
// Patterson 1976). Faces take turns. In every second turn hemicubes are rotated by 45 degrees about the normal of the
// face, so that their corners point where the edges' centers of the others point. Each hemicube is also turned by up
// to half a pixel at random, so that what falls between the pixels of one can be in a pixel of the next. Nearly valid
// viewpoints are used too, because a test with other directions may find them valid.
class guided_views {
 public:
  // where: the region of viewpoints of the grown box. Copied.
  guided_views(const ray_scene& rays, const viewpoint_region& where, const guided_settings& how);

  // Returns up to count poses; fewer if no more viewpoints are found. They depend on the arguments and on how many
  // poses were requested before.
  std::vector<pose> next(std::uint32_t count);
  // Returns the poses of full cubes at these viewpoints, two per cube. They count as taken; the sequence stays where it
  // is.
  std::vector<pose> cubes_at(std::span<const glm::vec3> eyes);
  // Returns the number of hemicubes so far, including those rendered before.
  std::uint32_t taken() const { return how_.taken; }
  // Returns the resolution of the hemicubes, pixels.
  std::uint32_t resolution() const { return how_.resolution; }

 private:
  // Returns the next pose on a face; nothing if all faces are in walls.
  std::optional<pose> on_a_face();
  // Returns the next viewpoint inside the box; nothing if none is found.
  std::optional<glm::vec3> inside();
  void turn_by_less_than_a_pixel(std::vector<pose>& poses);
  bool is_nearly_valid(const glm::vec3& eye) const { return rays_.is_nearly_valid(eye, how_.player_radius); }

  const ray_scene& rays_;
  const viewpoint_region where_;
  guided_settings how_;
  const std::array<boundary_face, 6> faces_;
  std::array<glm::vec2, 6> shifts_{};
  std::array<std::uint32_t, 6> used_{};  // indices into the sequence, per face
  std::array<bool, 6> walled_{};         // faces without valid viewpoints
  glm::vec3 shift_inside_{0.0f};
  std::uint32_t used_inside_ = 0, turns_ = 0;
  random_stream random_inside_;  // points inside where those of the sequence are not valid
  double due_inside_ = 0.0;      // hemicubes due inside
};

}  // namespace sightcell::bake
