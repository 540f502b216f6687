#pragma once
// The reliability map of importance-depth (sampler/importance_depth.h, which is the reference) on the device: nothing
// but the place where it is lowest is read back.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "sampler/importance_depth.h"
#include "sightcell/picture/gl_program.h"
#include "source/gpu_objects.h"

namespace sightcell::bake {

// Takes what reliability_map takes and answers as it does, but for rounding. The context must be current at every call.
class gpu_reliability_map {
 public:
  explicit gpu_reliability_map(const glm::vec2& face_size);

  void add_sample(const glm::vec2& place, const std::array<double, 4>& importance);
  void exclude(const glm::vec2& place);
  reliability_map::lowest_place lowest();
  std::vector<float> values();  // row by row; for tests

 private:
  struct sample {
    glm::vec2 place;
    std::array<double, 4> importance;
  };
  void update();

  glm::vec2 aspect_;
  double largest_ = 0.0;
  std::vector<sample> samples_;
  std::vector<std::array<std::uint32_t, 4>> excluded_;
  std::size_t drawn_samples_ = 0;  // that are in the map on the device
  bool changed_ = true;
  picture::gl_program raise_, lowest_;
  gl_buffer values_, lowest_of_groups_, result_, change_;
  std::optional<gl_buffer> sample_buffer_, excluded_buffer_;
};

}  // namespace sightcell::bake
