#pragma once
// Places on a regular grid over the face: what adaptive samplers are measured against.
#include <vector>

#include "sampler/face_sampler.h"

namespace sightcell::bake {

class uniform_grid final : public face_sampler {
 public:
  // Rows as far from each other as the places in them, as near as whole numbers come; rows may differ by one place, so
  // that there are samples of them, one at least.
  uniform_grid(const glm::vec2& face_size, std::uint32_t samples);
  std::optional<glm::vec2> next() override;
  void rendered(const glm::vec2&, const hemicube_view&) override {}
  void rejected(const glm::vec2&) override {}

 private:
  std::vector<glm::vec2> places_;
  std::size_t next_ = 0;
};

}  // namespace sightcell::bake
