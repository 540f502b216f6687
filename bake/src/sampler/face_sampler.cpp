#include "sampler/face_sampler.h"

#include <string>

#include "sampler/halton.h"
#include "sampler/importance_depth.h"
#include "sightcell/scene/error.h"

namespace sightcell::bake {

std::unique_ptr<face_sampler> make_face_sampler(std::string_view name, const glm::vec2& size, std::uint32_t samples,
                                                random_stream random) {
  if (name == "importance-depth") return std::make_unique<importance_depth>(size, samples);
  if (name == "halton") return std::make_unique<halton>(random);
  throw error(error_kind::wrong_use, "settings.out-of-range", "--sampler", "is \"" + std::string(name) + "\"",
              "give importance-depth or halton");
}

}  // namespace sightcell::bake
