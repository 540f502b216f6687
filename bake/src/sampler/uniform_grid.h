#pragma once
// Positions on a regular grid over the face: the reference for adaptive samplers.
#include <vector>

#include "sampler/face_sampler.h"

namespace sightcell::bake {

class uniform_grid final : public face_sampler {
 public:
  // The distance between rows is that of the positions in them, as far as whole numbers allow. Rows may differ by one
  // position, so that the total is samples, at least one.
  uniform_grid(const glm::vec2& face_size, std::uint32_t samples);
  std::optional<glm::vec2> next() override;
  void rendered(const glm::vec2&, const hemicube_view&) override {}
  void rejected(const glm::vec2&) override {}

 private:
  std::vector<glm::vec2> positions_;
  std::size_t next_ = 0;
};

}  // namespace sightcell::bake
