#pragma once
// Evenly spread positions: the Halton sequence in bases 2 and 3 with a random shift per face (Cranley and Patterson
// 1976).
#include "sampler/face_sampler.h"

namespace sightcell::bake {

class halton final : public face_sampler {
 public:
  explicit halton(random_stream random);
  std::optional<glm::vec2> next() override;
  void rendered(const glm::vec2&, const hemicube_view&) override { rejected_in_a_row_ = 0; }
  void rejected(const glm::vec2&) override { ++rejected_in_a_row_; }

 private:
  glm::vec2 shift_{0.0f};
  std::uint32_t index_ = 0;
  std::uint32_t rejected_in_a_row_ = 0;
};

}  // namespace sightcell::bake
