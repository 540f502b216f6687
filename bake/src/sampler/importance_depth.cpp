#include "sampler/importance_depth.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace sightcell::bake {
namespace {

// sigma^2 has this minimum, so that a sample with the largest importance still affects its surroundings.
constexpr double variance_floor = 0.02;
// A position that is no valid viewpoint excludes the texels within this distance (face coordinates). It is small
// enough to keep gaps of a few texels, and large enough that a wall takes tens of tries and not thousands.
constexpr float exclusion_reach = 1.0f / 48.0f;

// The start grid grows with the hemicubes that the face may use; the thesis used 3 to 5 with hundreds of samples.
std::uint32_t start_grid(std::uint32_t samples) {
  if (samples < 4) return 1;
  return samples < 16 ? 2 : 3;
}

}  // namespace

double sample_variance(double importance, double largest) {
  return std::max(1.0 - (largest > 0.0 ? importance / largest : 0.0), variance_floor);
}

reliability_map::reliability_map(const glm::vec2& face_size)
    : aspect_(face_size / std::max({face_size.x, face_size.y, 1e-6f})),
      values_(std::size_t{map_size} * map_size, 0.0f),
      row_lows_(map_size, 0.0f) {}

void reliability_map::add_sample(const glm::vec2& place, const std::array<double, 4>& importance) {
  samples_.push_back({place, importance});
  const double largest = *std::max_element(importance.begin(), importance.end());
  if (largest <= largest_) {
    raise_around(samples_.back());
    return;
  }
  largest_ = largest;
  std::fill(values_.begin(), values_.end(), 0.0f);
  for (const sample& s : samples_) raise_around(s);
  for (const glm::vec2& e : excluded_) apply_exclusion(e);
}

// R(p) = a exp(-|p-s|^2 / sH^2) + (1-a) exp(-|p-s|^2 / sV^2), a = du^2 / (du^2 + dv^2); values are only raised. Both
// exponentials are products of a factor per column and a factor per row, so some hundred are computed instead of two
// per texel, which took as long as rendering the hemicube.
void reliability_map::raise_around(const sample& s) {
  std::array<double, 4> variance{};
  for (std::size_t k = 0; k < 4; ++k) variance[k] = sample_variance(s.importance[k], largest_);
  // Per distance along one axis: its square, and the factors for the four variances.
  struct along {
    double square = 0.0;
    bool beyond = false;  // right of the sample, or above it
    std::array<double, 4> factor{};
  };
  using axis = std::array<along, map_size>;
  const auto measure = [&](float place, float aspect, axis& out) {
    for (std::uint32_t i = 0; i < map_size; ++i) {
      const double d = ((i + 0.5) / map_size - static_cast<double>(place)) * static_cast<double>(aspect);
      out[i].square = d * d;
      out[i].beyond = d > 0.0;
      for (std::size_t k = 0; k < 4; ++k) out[i].factor[k] = std::exp(-out[i].square / variance[k]);
    }
  };
  axis columns, rows;
  measure(s.place.x, aspect_.x, columns);
  measure(s.place.y, aspect_.y, rows);
  for (std::uint32_t y = 0; y < map_size; ++y) {
    const along& row = rows[y];
    const std::size_t v = row.beyond ? toward_up : toward_down;
    for (std::uint32_t x = 0; x < map_size; ++x) {
      const along& column = columns[x];
      const std::size_t h = column.beyond ? toward_right : toward_left;
      const double square = column.square + row.square;
      const double a = square > 0.0 ? column.square / square : 0.5;
      const double r = a * (column.factor[h] * row.factor[h]) + (1.0 - a) * (column.factor[v] * row.factor[v]);
      float& value = values_[y * map_size + x];
      value = std::max(value, static_cast<float>(r));
    }
    find_row_low(y);
  }
}

void reliability_map::exclude(const glm::vec2& place) {
  excluded_.push_back(place);
  apply_exclusion(place);
}

std::array<std::uint32_t, 4> reliability_map::excluded_texels(const glm::vec2& place) {
  const auto texel = [](float v) {
    return static_cast<std::uint32_t>(std::clamp(v * map_size, 0.0f, float{map_size} - 1.0f));
  };
  return {texel(place.x - exclusion_reach), texel(place.y - exclusion_reach), texel(place.x + exclusion_reach),
          texel(place.y + exclusion_reach)};
}

void reliability_map::apply_exclusion(const glm::vec2& place) {
  const auto [left, low, right, high] = excluded_texels(place);
  for (std::uint32_t y = low; y <= high; ++y) {
    for (std::uint32_t x = left; x <= right; ++x) values_[y * map_size + x] = 1.0f;
    find_row_low(y);
  }
}

void reliability_map::find_row_low(std::uint32_t y) {
  const float* row = values_.data() + std::size_t{y} * map_size;
  row_lows_[y] = *std::min_element(row, row + map_size);
}

glm::vec2 reliability_map::center_of(std::uint32_t texel) {
  return glm::vec2{static_cast<float>(texel % map_size) + 0.5f, static_cast<float>(texel / map_size) + 0.5f} /
         static_cast<float>(map_size);
}

reliability_map::lowest_place reliability_map::lowest() const {
  const auto y = static_cast<std::uint32_t>(std::min_element(row_lows_.begin(), row_lows_.end()) - row_lows_.begin());
  const float* row = values_.data() + std::size_t{y} * map_size;
  const auto x = static_cast<std::uint32_t>(std::find(row, row + map_size, row_lows_[y]) - row);
  return {row_lows_[y], center_of(y * map_size + x)};
}

importance_depth::importance_depth(const glm::vec2& face_size, const face_options& how)
    : map_(face_size),
      reliable_enough_(static_cast<float>(how.reliability)),
      grid_(how.start_grid > 0 ? how.start_grid : start_grid(how.samples)) {}

std::optional<glm::vec2> importance_depth::next() {
  if (grid_next_ < grid_ * grid_) {
    const glm::vec2 tile{static_cast<float>(grid_next_ % grid_), static_cast<float>(grid_next_ / grid_)};
    ++grid_next_;
    return (tile + 0.5f) / static_cast<float>(grid_);
  }
  const auto lowest = map_.lowest();
  if (lowest.reliability >= reliable_enough_) return std::nullopt;
  return lowest.place;
}

void importance_depth::rendered(const glm::vec2& place, const hemicube_view& view) {
  map_.add_sample(place, view.importance);
}

void importance_depth::rejected(const glm::vec2& place) {
  map_.exclude(place);
}

}  // namespace sightcell::bake
