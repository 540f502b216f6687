#pragma once
// Where the hemicubes of `guided` stand: evenly spread over the faces of the cell and, where geometry is inside, over
// its inside, however many there come to be.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "search/boundary_face.h"
#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct guided_places {
  std::uint64_t seed = 0, place = 0;
  float player_radius = 0.05f;
  bool geometry_inside = false;
  double interior_share = 0.25;  // of the hemicubes, where geometry is inside: two by two they are full cubes
  std::uint32_t resolution = 256;
  std::uint32_t taken = 0;  // by whoever looked into the cell before: the sequence goes on after them
};

// The Halton sequence in bases 2 and 3 per face, in bases 2, 3 and 5 inside, shifted at random (Cranley and Patterson
// 1976). Faces take turns. Every second turn hemicubes are rotated by 45 degrees about the face's normal, so that the
// corners of one are the middles of edges of the next, and each is turned by up to half a pixel at random: what hides
// between the pixels of one does not hide in the next. They stand in places that are nearly free,
// too: whoever tells solids by other directions may find such a place free.
class guided_views {
 public:
  guided_views(const ray_scene& rays, const box& grown, const guided_places& how);

  // The next poses; fewer where no more places are found. They depend on the arguments and on how many were
  // asked for before.
  std::vector<pose> next(std::uint32_t count);
  std::uint32_t taken() const { return how_.taken; }
  std::uint32_t resolution() const { return how_.resolution; }

 private:
  std::optional<pose> on_a_face();
  std::optional<glm::vec3> inside();
  bool may_look_from(const glm::vec3& eye) const { return rays_.is_nearly_free(eye, how_.player_radius); }

  const ray_scene& rays_;
  const box grown_;
  guided_places how_;
  const std::array<boundary_face, 6> faces_;
  std::array<glm::vec2, 6> shifts_{};
  std::array<std::uint32_t, 6> used_{};  // places of the sequence, of each face
  std::array<bool, 6> walled_{};
  glm::vec3 shift_inside_{0.0f};
  std::uint32_t used_inside_ = 0, turns_ = 0;
  random_stream anywhere_;    // inside, where the sequence meets walls
  double owed_inside_ = 0.0;  // hemicubes
};

}  // namespace sightcell::bake
