#pragma once
// The hemicubes of one cell, as a bake takes them, with a source and a set of the test's own.
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>

#include "sampler/face_sampling.h"
#include "sampler/nir04.h"
#include "search/hemicubes.h"

namespace sightcell::bake {

struct sampling_plan {
  std::string_view sampler;
  std::uint32_t samples = 0;
  bool geometry_inside = false;
  std::uint64_t seed = 0, place = 0;
};

// Returns how many hemicubes were rendered.
inline std::uint32_t sample_cell(const sampling_plan& how, const box& grown, std::span<const glm::vec3> interior,
                                 const std::function<bool(const glm::vec3&)>& is_valid, hemicube_source& source,
                                 cell_set& set) {
  const hemicube_plan plan{
      .samples = how.samples, .seed = how.seed, .place = how.place, .geometry_inside = how.geometry_inside};
  hemicubes taken(plan, source, set);
  taken.take_interior(interior);
  if (how.sampler == "nir04")
    sample_nir04({}, grown, is_valid, taken);
  else
    sample_faces({.sampler = how.sampler}, plan, grown, is_valid, taken);
  return taken.taken();
}

}  // namespace sightcell::bake
