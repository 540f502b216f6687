#include "stream/reduced_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

namespace sightcell::bake {
namespace {

float light_of(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

// Between the numbers of a file and what means are taken of.
struct number_scale {
  std::array<float, 256> value;  // of a byte
  std::array<float, 255> upper;  // where the next byte begins

  explicit number_scale(bool is_color) {
    const auto of = [&](float number) { return is_color ? light_of(number / 255.0f) : number / 255.0f; };
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = of(static_cast<float>(i));
    for (std::size_t i = 0; i < upper.size(); ++i) upper[i] = of(static_cast<float>(i) + 0.5f);
  }
  std::uint8_t byte_of(float v) const {
    return static_cast<std::uint8_t>(std::upper_bound(upper.begin(), upper.end(), v) - upper.begin());
  }
};

// The one or two new pixels that a pixel lies in on one axis, and its parts in them.
struct pixel_share {
  std::uint32_t first = 0, second = 0;
  float in_first = 1.0f, in_second = 0.0f;
};

std::vector<pixel_share> shares_of(std::uint32_t from, std::uint32_t to) {
  std::vector<pixel_share> out(from);
  for (std::uint64_t i = 0; i < from; ++i) {
    const std::uint64_t begin = i * to, end = begin + to;  // new pixels are `from` wide
    pixel_share& s = out[i];
    s.first = static_cast<std::uint32_t>(begin / from);
    s.second = static_cast<std::uint32_t>((end - 1) / from);
    if (s.first != s.second) {
      s.in_second = static_cast<float>(end - std::uint64_t{s.second} * from) / static_cast<float>(to);
      s.in_first = 1.0f - s.in_second;
    }
  }
  return out;
}

struct pixel_sum {
  glm::vec3 rgb{0.0f};
  float alpha = 0.0f, weight = 0.0f, area = 0.0f;

  void add(const pixel_sum& other, float part) {
    rgb += other.rgb * part;
    alpha += other.alpha * part, weight += other.weight * part, area += other.area * part;
  }
};

std::vector<pixel_sum> sums_of(const scene::image_pixels& source, std::uint32_t width, std::uint32_t height,
                               const number_scale& scale, bool alpha_is_coverage) {
  // So little that only colors without any other one beside them count.
  constexpr float weight_of_nothing = 1.0f / 4096;
  const std::vector<pixel_share> columns = shares_of(source.width, width), rows = shares_of(source.height, height);
  std::vector<pixel_sum> out(std::size_t{width} * height), row(width);
  const std::uint8_t* at = source.rgba.data();
  for (std::uint32_t y = 0; y < source.height; ++y) {
    std::fill(row.begin(), row.end(), pixel_sum{});
    for (std::uint32_t x = 0; x < source.width; ++x, at += 4) {
      pixel_sum one;
      one.alpha = static_cast<float>(at[3]) / 255.0f;
      one.weight = alpha_is_coverage ? std::max(one.alpha, weight_of_nothing) : 1.0f;
      one.rgb = one.weight * glm::vec3(scale.value[at[0]], scale.value[at[1]], scale.value[at[2]]);
      one.area = 1.0f;
      row[columns[x].first].add(one, columns[x].in_first);
      if (columns[x].second != columns[x].first) row[columns[x].second].add(one, columns[x].in_second);
    }
    for (std::uint32_t x = 0; x < width; ++x) {
      out[std::size_t{rows[y].first} * width + x].add(row[x], rows[y].in_first);
      if (rows[y].second != rows[y].first) out[std::size_t{rows[y].second} * width + x].add(row[x], rows[y].in_second);
    }
  }
  return out;
}

glm::vec3 with_length_1(const glm::vec3& color) {
  const glm::vec3 vector = 2.0f * color - 1.0f;
  const float length = glm::length(vector);
  return length < 1e-3f ? color : 0.5f * vector / length + 0.5f;
}

// Returns the value that `wanted` values reach, or as near to so many as equal ones allow.
float threshold_for(std::vector<float> values, std::size_t wanted) {
  std::sort(values.begin(), values.end(), std::greater<>());
  const auto range = std::equal_range(values.begin(), values.end(), values[wanted - 1], std::greater<>());
  const auto above = static_cast<std::size_t>(range.first - values.begin()),
             reached = static_cast<std::size_t>(range.second - values.begin());
  return above > 0 && wanted - above < reached - wanted ? values[above - 1] : values[wanted - 1];
}

// Scales alphas so that the same part of them reaches the cutoff as in the source.
void keep_coverage(const scene::image_pixels& source, float cutoff, std::vector<float>& alphas) {
  const float least = std::ceil(cutoff * 255.0f - 1e-3f);  // byte that passes
  if (!(least >= 1.0f && least <= 255.0f)) return;
  std::size_t passing = 0;
  for (std::size_t i = 3; i < source.rgba.size(); i += 4) passing += static_cast<float>(source.rgba[i]) >= least;
  const std::size_t all = source.rgba.size() / 4;
  const auto wanted = static_cast<std::size_t>(
      std::llround(static_cast<double>(passing) / static_cast<double>(all) * static_cast<double>(alphas.size())));
  if (wanted == 0 || wanted == alphas.size()) return;
  const float threshold = threshold_for(alphas, wanted);
  if (!(threshold > 0.0f)) return;
  for (float& alpha : alphas) {
    const bool passes = alpha >= threshold;
    alpha = std::clamp(alpha / threshold * least, passes ? least : 0.0f, passes ? 255.0f : least - 1.0f) / 255.0f;
  }
}

}  // namespace

scene::image_pixels reduced(const scene::image_pixels& source, std::uint32_t width, std::uint32_t height,
                            const scene::image_use& use) {
  const bool alpha_is_coverage = use.alpha == scene::alpha_use::blended || use.alpha == scene::alpha_use::tested;
  const number_scale scale(use.is_color);
  const std::vector<pixel_sum> sums = sums_of(source, width, height, scale, alpha_is_coverage);
  std::vector<float> alphas;
  for (const pixel_sum& sum : sums) alphas.push_back(use.alpha == scene::alpha_use::none ? 1.0f : sum.alpha / sum.area);
  if (use.alpha == scene::alpha_use::tested) keep_coverage(source, use.cutoff, alphas);
  scene::image_pixels out{width, height, {}};
  out.rgba.reserve(4 * sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    glm::vec3 color = sums[i].rgb / sums[i].weight;
    if (use.has_normals) color = with_length_1(color);
    for (int k = 0; k < 3; ++k) out.rgba.push_back(scale.byte_of(color[k]));
    out.rgba.push_back(static_cast<std::uint8_t>(std::lround(alphas[i] * 255.0f)));
  }
  return out;
}

}  // namespace sightcell::bake
