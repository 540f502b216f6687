#include "sampler/halton.h"

#include <glm/common.hpp>

#include "search/radical_inverse.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t give_up_after = 256;  // consecutive rejected positions after which the face counts as a wall

}  // namespace

halton::halton(random_stream random) {
  shift_.x = random.uniform();
  shift_.y = random.uniform();
}

std::optional<glm::vec2> halton::next() {
  if (rejected_in_a_row_ >= give_up_after) return std::nullopt;
  ++index_;
  return glm::fract(glm::vec2{radical_inverse(index_, 2), radical_inverse(index_, 3)} + shift_);
}

}  // namespace sightcell::bake
