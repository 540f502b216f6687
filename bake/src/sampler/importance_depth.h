#pragma once
// The importance sampler of the thesis (docs/method/samplers.md). A map of reliability over the face is raised around
// every sample, over a smaller distance in directions where the sample found depth gaps. The next sample is placed at
// the minimum.
#include <array>
#include <cstdint>
#include <vector>

#include "sampler/face_sampler.h"

namespace sightcell::bake {

// Returns sigma^2 in one direction of a sample: the smaller, the closer its importance in that direction is to the
// largest one.
double sample_variance(double importance, double largest);

// The reliability R over one face: map_size x map_size values in [0, 1], texel centers at (i + 0.5) / map_size.
class reliability_map {
 public:
  static constexpr std::uint32_t map_size = 256;

  // Returns the first column and row and the last column and row of the texels that are excluded for an invalid
  // viewpoint.
  static std::array<std::uint32_t, 4> excluded_texels(const glm::vec2& place);
  static glm::vec2 center_of(std::uint32_t texel);  // texels are numbered row by row

  explicit reliability_map(const glm::vec2& face_size);

  // Adds a sample with the sums of I_p toward right, up, left and down. All sums are normalized by the largest
  // component of any sample of this face so far, so a new maximum rebuilds the map.
  void add_sample(const glm::vec2& place, const std::array<double, 4>& importance);
  // Marks texels within reach of an invalid viewpoint as reliable, in face coordinates.
  void exclude(const glm::vec2& place);

  struct lowest_place {
    float reliability;
    glm::vec2 place;
  };
  lowest_place lowest() const;  // of equal values the first in row order
  float at(std::uint32_t x, std::uint32_t y) const { return values_[y * map_size + x]; }

 private:
  struct sample {
    glm::vec2 place;
    std::array<double, 4> importance;
  };
  void raise_around(const sample& s);
  void apply_exclusion(const glm::vec2& place);
  void find_row_low(std::uint32_t y);

  glm::vec2 aspect_;  // face size divided by its longest side
  double largest_ = 0.0;
  std::vector<sample> samples_;
  std::vector<glm::vec2> excluded_;
  std::vector<float> values_;
  std::vector<float> row_lows_;  // lowest value of each row, because a face in a wall requests the minimum very often
};

class importance_depth final : public face_sampler {
 public:
  importance_depth(const glm::vec2& face_size, const face_options& how);
  std::optional<glm::vec2> next() override;
  void rendered(const glm::vec2& place, const hemicube_view& view) override;
  void rejected(const glm::vec2& place) override;

  const reliability_map& map() const { return map_; }

 private:
  reliability_map map_;
  float reliable_enough_;  // a face is finished when no value is lower (step 5 of the thesis)
  std::uint32_t grid_;     // the start grid has grid_ x grid_ samples
  std::uint32_t grid_next_ = 0;
};

}  // namespace sightcell::bake
