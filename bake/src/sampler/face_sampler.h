#pragma once
// Where on a boundary face the next hemicube goes. One object per face of a cell; the driver asks for a place, tests
// that it is free, renders and tells what came out.
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string_view>

#include "random.h"
#include "sampler/boundary_face.h"

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

// The samplers by name; throws sightcell::error for an unknown one. samples: how many this face will get at most.
// size: of the face in metres.
std::unique_ptr<face_sampler> make_face_sampler(std::string_view name, const glm::vec2& size, std::uint32_t samples,
                                                random_stream random);

}  // namespace sightcell::bake
