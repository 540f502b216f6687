#include "sampler/face_sampler.h"

#include <string>

#include "sampler/halton.h"
#include "sampler/importance_depth.h"
#include "sampler/uniform_grid.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {

std::unique_ptr<face_sampler> make_face_sampler(const face_options& how, const glm::vec2& size, random_stream random) {
  if (how.sampler == "importance-depth" || how.sampler == "importance-depth-color")
    return std::make_unique<importance_depth>(size, how);
  if (how.sampler == "halton") return std::make_unique<halton>(random);
  if (how.sampler == "uniform") return std::make_unique<uniform_grid>(size, how.samples);
  throw error(error_kind::wrong_use, "settings.out-of-range", "--sampler", "is \"" + std::string(how.sampler) + "\"",
              "give one that places hemicubes on faces");
}

}  // namespace sightcell::bake
