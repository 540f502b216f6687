#pragma once
// Where on a boundary face the next hemicube goes. One object per face of a cell; the driver asks for a place, tests
// that it is free, renders and tells what came out.
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string_view>

#include "search/boundary_face.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {

class face_sampler {
 public:
  virtual ~face_sampler() = default;
  // The next place in [0,1] x [0,1], or nothing when the sampler is content or has no place left.
  virtual std::optional<glm::vec2> next() = 0;
  virtual void rendered(const glm::vec2& place, const hemicube_view& view) = 0;
  // The place is not free (in a wall or in a solid): another is wanted.
  virtual void rejected(const glm::vec2& place) = 0;
};

struct face_options {
  std::string_view sampler;      // by name
  std::uint32_t samples = 0;     // how many the face will get at most
  double reliability = 0.995;    // of importance-depth, as is the next one
  std::uint32_t start_grid = 0;  // 0: by samples
};

// size: of the face in metres. Throws sightcell::error for a name that is not that of a face sampler.
std::unique_ptr<face_sampler> make_face_sampler(const face_options& how, const glm::vec2& size, random_stream random);

}  // namespace sightcell::bake
