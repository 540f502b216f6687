#pragma once
// Chooses the position of the next hemicube on a boundary face. There is one object per face of a cell. The caller
// requests a position, tests whether it is a valid viewpoint, renders and reports the result.
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string_view>

#include "search/boundary_face.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {

// Chooses positions on one face.
class face_sampler {
 public:
  virtual ~face_sampler() = default;
  // Returns the next position in [0,1] x [0,1]; nothing if the sampler is finished.
  virtual std::optional<glm::vec2> next() = 0;
  // Reports the hemicube at the position.
  virtual void rendered(const glm::vec2& place, const hemicube_view& view) = 0;
  // Reports that the position is no valid viewpoint, so another one is needed.
  virtual void rejected(const glm::vec2& place) = 0;
};

// The parameters of a face sampler.
struct face_options {
  std::string_view sampler;      // name
  std::uint32_t samples = 0;     // limit for the face
  double reliability = 0.995;    // of importance-depth, like start_grid
  std::uint32_t start_grid = 0;  // 0: chosen from samples
};

// size: of the face, meters. Throws sightcell::error if the sampler does not exist or does not sample faces.
std::unique_ptr<face_sampler> make_face_sampler(const face_options& how, const glm::vec2& size, random_stream random);

}  // namespace sightcell::bake
