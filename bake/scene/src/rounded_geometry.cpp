#include "rounded_geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "gltf_numbers.h"
#include "meshopt_encode.h"
#include "world_point.h"

namespace sightcell::scene {
namespace {

constexpr double largest_mantissa = 8'388'607.0;  // 24 bits with sign
constexpr int smallest_exponent = -100, largest_exponent = 100;

// A number for the filter EXPONENTIAL: 24 bits of mantissa, 8 of exponent.
std::uint32_t exponential(float value, int exponent) {
  const auto mantissa = static_cast<std::int32_t>(std::nearbyint(std::ldexp(static_cast<double>(value), -exponent)));
  return (static_cast<std::uint32_t>(mantissa) & 0xFFFFFFu) | static_cast<std::uint32_t>(exponent & 0xFF) << 24;
}

float decoded(std::uint32_t word) {
  const auto mantissa = static_cast<std::int32_t>(word << 8) >> 8;
  return static_cast<float>(std::ldexp(static_cast<double>(mantissa), static_cast<std::int32_t>(word) >> 24));
}

// Returns the exponent, or the next one with which all values fit the mantissa.
int exponent_for(double largest, int exponent) {
  int e = std::clamp(exponent, smallest_exponent, largest_exponent);
  while (std::ldexp(largest, -e) > largest_mantissa) ++e;
  return e;
}

double largest_of(const std::vector<float>& values) {
  double largest = 0.0;
  for (const float v : values) largest = std::max(largest, std::abs(static_cast<double>(v)));
  return largest;
}

void put_u32(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}

class vertex_rounder {
 public:
  vertex_rounder(const geometry& g, const attribute_values& values, const rounding_steps& steps)
      : g_(g), values_(values), steps_(steps), count_(g.positions.size()) {}

  std::vector<std::uint8_t> stream(const vertex_stream& s) const {
    if (s.filter == stream_filter::octahedral) return directions(s.attributes.front());
    std::vector<std::uint8_t> bytes(count_ * s.stride);
    for (const stream_attribute& a : s.attributes) {
      if (a.name == "POSITION")
        put_positions(s, a, bytes);
      else if (s.filter == stream_filter::exponential)
        put_coordinates(s, a, bytes);
      else
        put_colors(s, a, bytes);
    }
    return bytes;
  }

 private:
  void put_positions(const vertex_stream& s, const stream_attribute& a, std::vector<std::uint8_t>& bytes) const {
    double largest = 0.0;
    for (const glm::vec3& p : g_.positions)
      if (is_finite(p))
        for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(static_cast<double>(p[k])));
    const int exponent = exponent_for(largest, steps_.positions);
    for (std::size_t i = 0; i < count_; ++i) {
      const glm::vec3 p = is_finite(g_.positions[i]) ? g_.positions[i] : glm::vec3(0.0f);
      for (int k = 0; k < 3; ++k)
        put_u32(bytes, i * s.stride + a.offset + 4 * static_cast<std::size_t>(k), exponential(p[k], exponent));
    }
  }

  void put_coordinates(const vertex_stream& s, const stream_attribute& a, std::vector<std::uint8_t>& bytes) const {
    const std::vector<float>& values = values_.at(a.name);
    const int exponent = exponent_for(largest_of(values), steps_.coordinates);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = 0; k < a.width; ++k)
        put_u32(bytes, i * s.stride + a.offset + 4 * k, exponential(values[i * a.width + k], exponent));
  }

  std::vector<std::uint8_t> directions(const stream_attribute& a) const {
    const std::vector<float>& values = values_.at(a.name);
    std::vector<float> vectors(4 * count_, 0.0f);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = 0; k < a.width; ++k) vectors[4 * i + k] = values[i * a.width + k];
    return encode_directions(vectors);
  }

  void put_colors(const vertex_stream& s, const stream_attribute& a, std::vector<std::uint8_t>& bytes) const {
    const std::vector<float>& values = values_.at(a.name);
    const std::size_t width = values.size() / count_;
    const bool small = a.component_type == unsigned_byte_type;
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = 0; k < 4; ++k) {
        const float v = k < width ? std::clamp(values[i * width + k], 0.0f, 1.0f) : 1.0f;
        const auto number = static_cast<std::uint16_t>(std::lround(v * (small ? 255.0f : 65535.0f)));
        std::memcpy(&bytes[i * s.stride + a.offset + (small ? k : 2 * k)], &number, small ? 1 : 2);
      }
  }

  const geometry& g_;
  const attribute_values& values_;
  const rounding_steps& steps_;
  std::size_t count_;
};

static_assert(std::endian::native == std::endian::little, "streams are written as they are in memory");

// Leaves one of each group of equal vertices. vertex: by old number, the number of the first equal one.
void keep_unique(const std::vector<std::uint32_t>& vertex, rounded_geometry& g) {
  std::vector<std::uint32_t> number(vertex.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    number[i] = vertex[i] == i ? kept++ : number[vertex[i]];
    if (vertex[i] != i) continue;
    for (std::size_t s = 0; s < g.streams.size(); ++s) {
      const std::size_t stride = g.layout[s].stride;
      std::memmove(&g.streams[s][number[i] * stride], &g.streams[s][i * stride], stride);
    }
  }
  for (std::size_t s = 0; s < g.streams.size(); ++s) g.streams[s].resize(std::size_t{kept} * g.layout[s].stride);
  for (std::uint32_t& corner : g.corners) corner = number[corner];
  g.vertices = kept;
}

// Makes polygons with two corners in one place lines of one vertex: is_drawn() is false for them.
void collapse_lines(rounded_geometry& g) {
  const auto place = [&](std::uint32_t vertex) { return &g.streams[0][std::size_t{vertex} * g.layout[0].stride]; };
  const auto coincide = [&](std::uint32_t a, std::uint32_t b) { return std::memcmp(place(a), place(b), 12) == 0; };
  for (std::size_t i = 0; i + 2 < g.corners.size(); i += 3) {
    std::uint32_t* const c = &g.corners[i];
    if (coincide(c[0], c[1]) || coincide(c[1], c[2]) || coincide(c[2], c[0])) c[1] = c[2] = c[0];
  }
}

}  // namespace

int exponent_of(double step) {
  if (!(step > 0.0) || !std::isfinite(step)) return smallest_exponent;
  return std::clamp(std::ilogb(step), smallest_exponent, largest_exponent);
}

bool rounded_geometry::is_drawn(std::uint32_t polygon) const {
  const std::uint32_t* const c = &corners[3 * std::size_t{polygon}];
  return c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
}

glm::vec3 position_of(const rounded_geometry& g, std::uint32_t vertex) {
  glm::vec3 p;
  for (int k = 0; k < 3; ++k) {
    std::uint32_t word = 0;
    std::memcpy(&word, &g.streams[0][std::size_t{vertex} * g.layout[0].stride + 4 * static_cast<std::size_t>(k)], 4);
    p[k] = decoded(word);
  }
  return p;
}

rounded_geometry round_geometry(const geometry& g, const attribute_values& values, const rounding_steps& steps) {
  rounded_geometry out;
  out.layout = layout_of(values, g.positions.size());
  const vertex_rounder rounder(g, values, steps);
  std::vector<vertex_bytes> views;
  for (const vertex_stream& s : out.layout) out.streams.push_back(rounder.stream(s));
  for (std::size_t s = 0; s < out.layout.size(); ++s) views.push_back({out.streams[s], out.layout[s].stride});
  out.corners = g.indices;
  // A polygon with a corner that is not finite is nowhere.
  for (std::size_t i = 0; i + 2 < out.corners.size(); i += 3)
    if (!is_finite(g.positions[g.indices[i]]) || !is_finite(g.positions[g.indices[i + 1]]) ||
        !is_finite(g.positions[g.indices[i + 2]]))
      out.corners[i + 1] = out.corners[i + 2] = out.corners[i];
  keep_unique(first_equal(views, g.positions.size()), out);
  collapse_lines(out);
  out.min = glm::vec3(std::numeric_limits<float>::infinity()), out.max = -out.min;
  for (std::uint32_t i = 0; i < out.vertices; ++i) {
    const glm::vec3 p = position_of(out, i);
    for (int k = 0; k < 3; ++k) out.min[k] = std::min(out.min[k], p[k]), out.max[k] = std::max(out.max[k], p[k]);
  }
  if (out.vertices == 0) out.min = out.max = glm::vec3(0.0f);
  return out;
}

}  // namespace sightcell::scene
