#pragma once
// The thesis's importance sampler (docs/method/samplers.md): a map of reliability over the face, raised around every
// sample, less far toward the sides where the sample saw gaps; the next sample goes where reliability is lowest.
#include <array>
#include <cstdint>
#include <vector>

#include "sampler/face_sampler.h"

namespace sightcell::bake {

// sigma^2 toward one side of a sample: the smaller the more its importance toward there is of the largest one.
double sample_variance(double importance, double largest);

// R over one face: map_size x map_size values in [0, 1], texel centers at (i + 0.5) / map_size.
class reliability_map {
 public:
  static constexpr std::uint32_t map_size = 256;

  // First column and row, last column and row of the texels that go when nothing can stand at place.
  static std::array<std::uint32_t, 4> excluded_texels(const glm::vec2& place);
  static glm::vec2 center_of(std::uint32_t texel);  // counted row by row

  explicit reliability_map(const glm::vec2& face_size);

  // A sample at place with the sums of I_p toward right, up, left, down. All sums are normalised by the largest
  // component of any sample of this face so far, so a new maximum rebuilds the map.
  void add_sample(const glm::vec2& place, const std::array<double, 4>& importance);
  // Nothing can stand there: texels within reach of place (both in face coordinates) count as reliable.
  void exclude(const glm::vec2& place);

  struct lowest_place {
    float reliability;
    glm::vec2 place;
  };
  lowest_place lowest() const;  // ties: first in row order
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
  std::vector<float> row_lows_;  // the lowest value of each row: a face in a wall asks for the lowest of all very often
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
  float reliable_enough_;  // a face is done when the map is nowhere below (step 5 of the thesis)
  std::uint32_t grid_;     // the start grid is grid_ x grid_
  std::uint32_t grid_next_ = 0;
};

}  // namespace sightcell::bake
