#include "touched/touched_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

namespace sightcell::bake {
namespace {

constexpr int code_shift = 19;                                           // leaves four bits of the mantissa
constexpr std::uint32_t first_code = (127u - 12u) << (23 - code_shift);  // 2^-12 per meter
constexpr float beside = 1.0f / 16.0f;                                   // blocks; for rounding in the rasterizer
constexpr float nearest = 1e-6f;             // meters; what is nearer to the plane of the eye is cut
constexpr float rounding_of_corner = 1e-6f;  // per meter from the origin and from the eye

// Returns at most the inverse depth for which code_of() returned the code.
float inverse_depth_of(std::uint8_t code) {
  return code == 0 ? 0.0f : std::bit_cast<float>((first_code + code) << code_shift);
}

// A convex solid or polygon in the space of a face, and the blocks that it may cover.
struct image_bounds {
  int first[2] = {}, last[2] = {};  // column and row
  float inverse_depth = 0.0f;       // of its nearest point; infinity if it reaches the plane of the eye
};

glm::vec3 in_face(const touched_face& face, const glm::vec3& point) {
  const glm::vec3 to = point - face.eye;
  return {glm::dot(to, face.right), glm::dot(to, face.up), glm::dot(to, face.forward)};
}

// corners: in the space of the face. Returns nothing if no block is covered.
std::optional<image_bounds> bounds_of(const touched_face& face, std::span<const glm::vec3> corners) {
  float low[2], high[2];
  std::fill_n(low, 2, std::numeric_limits<float>::infinity());
  std::fill_n(high, 2, -std::numeric_limits<float>::infinity());
  float least = std::numeric_limits<float>::infinity();
  const auto add = [&](const glm::vec3& point) {
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], point[axis] / point.z);
      high[axis] = std::max(high[axis], point[axis] / point.z);
    }
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    least = std::min(least, corners[i].z);
    if (corners[i].z >= nearest) add(corners[i]);
    // The cut is the hull of all places where a line between two corners crosses it.
    for (std::size_t j = 0; j < i; ++j) {
      const float a = corners[i].z - nearest, b = corners[j].z - nearest;
      if ((a < 0.0f) == (b < 0.0f)) continue;
      const glm::vec3 crossing = corners[i] + (corners[j] - corners[i]) * (a / (a - b));
      add({crossing.x, crossing.y, nearest});
    }
  }
  image_bounds found;
  const float start[2] = {face.min_x, face.min_y};
  const std::uint32_t count[2] = {face.columns, face.rows};
  for (int axis = 0; axis < 2; ++axis) {
    const float from = std::floor((low[axis] - start[axis]) / face.step - beside);
    const float to = std::floor((high[axis] - start[axis]) / face.step + beside);
    const float most = static_cast<float>(count[axis]) - 1.0f;
    if (!(to >= 0.0f && from <= most)) return std::nullopt;
    found.first[axis] = static_cast<int>(std::max(from, 0.0f));
    found.last[axis] = static_cast<int>(std::min(to, most));
  }
  found.inverse_depth = least > nearest ? 1.0f / least : std::numeric_limits<float>::infinity();
  return found;
}

// Linear functions over the image plane, by which blocks beside a triangle and blocks that see less far are left out.
struct triangle_in_image {
  triangle_in_image(const glm::vec3& eye, const std::array<glm::vec3, 3>& c) {
    const std::array<glm::vec3, 3> along{c[1] - c[0], c[2] - c[1], c[0] - c[2]};
    const glm::vec3 normal = glm::cross(along[0], along[1]);
    const float area = glm::length(normal), offset = glm::dot(normal, c[0]);
    const float far = std::max({glm::length(c[0]), glm::length(c[1]), glm::length(c[2])});
    const float longest = std::max({glm::length(along[0]), glm::length(along[1]), glm::length(along[2])});
    // Small triangles and those seen edge-on have no direction after rounding.
    const float error = rounding_of_corner * (far + glm::length(eye));
    if (!(std::abs(offset) > far * std::max(10.0f * error * longest, 1e-5f * area))) return;
    has_area = true;
    inverse_depth = normal / offset;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec3 edge = glm::cross(c[i], along[i]);
      edges[i] = edge * ((offset < 0.0f ? -1.0f : 1.0f) / std::max(glm::length(edge), 1e-30f));
    }
  }

  // Returns the largest value of a function in a block.
  static float most(const glm::vec3& function, float a, float b, float half) {
    return function.x * a + function.y * b + function.z + (std::abs(function.x) + std::abs(function.y)) * half;
  }

  bool has_area = false;  // else it has no functions
  glm::vec3 inverse_depth{0.0f}, edges[3] = {};
};

// Returns whether a block has pixels that see as far as the polygon.
bool sees(const touched_face& face, std::span<const std::uint8_t> codes, const image_bounds& where,
          const triangle_in_image* triangle) {
  for (int y = where.first[1]; y <= where.last[1]; ++y)
    for (int x = where.first[0]; x <= where.last[0]; ++x) {
      const float far =
          inverse_depth_of(codes[static_cast<std::size_t>(y) * face.columns + static_cast<std::size_t>(x)]);
      if (where.inverse_depth < far) continue;
      if (triangle == nullptr || !triangle->has_area) return true;
      const float a = face.min_x + (static_cast<float>(x) + 0.5f) * face.step;
      const float b = face.min_y + (static_cast<float>(y) + 0.5f) * face.step;
      const auto is_outside = [&](const glm::vec3& edge) {
        return triangle_in_image::most(edge, a, b, face.reach) < -1e-6f;
      };
      if (std::any_of(std::begin(triangle->edges), std::end(triangle->edges), is_outside)) continue;
      if (triangle_in_image::most(triangle->inverse_depth, a, b, face.reach) * 1.001f >= far) return true;
    }
  return false;
}

template <class Number>
void put_number(std::vector<std::uint8_t>& out, const Number& number) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
  out.insert(out.end(), bytes, bytes + sizeof(number));
}

static_assert(sizeof(touched_face) == 18 * 4);

std::size_t blocks_of(const touched_face& face) {
  return std::size_t{face.columns} * face.rows;
}

}  // namespace

std::span<std::uint8_t> touched_faces::add(const touched_face& face) {
  faces_.push_back(face);
  const std::size_t before = codes_.size();
  codes_.resize(before + blocks_of(face));
  return std::span(codes_).subspan(before);
}

void touched_faces::add(const touched_faces& other) {
  faces_.insert(faces_.end(), other.faces_.begin(), other.faces_.end());
  codes_.insert(codes_.end(), other.codes_.begin(), other.codes_.end());
}

std::uint8_t touched_faces::code_of(float inverse_depth) {
  const float far = inverse_depth / (1.0001f + 1e-3f * inverse_depth);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(far) >> code_shift;
  return static_cast<std::uint8_t>(std::min(std::max(bits, first_code) - first_code, 255u));
}

bool touched_faces::meets(const std::array<glm::vec3, 3>& corners) const {
  const std::uint8_t* codes = codes_.data();
  for (const touched_face& face : faces_) {
    std::array<glm::vec3, 3> here;
    std::transform(corners.begin(), corners.end(), here.begin(), [&](const glm::vec3& p) { return in_face(face, p); });
    if (const auto where = bounds_of(face, here)) {
      const triangle_in_image triangle(face.eye, here);
      if (sees(face, {codes, blocks_of(face)}, *where, &triangle)) return true;
    }
    codes += blocks_of(face);
  }
  return false;
}

bool touched_faces::meets(const box& where) const {
  const std::uint8_t* codes = codes_.data();
  for (const touched_face& face : faces_) {
    std::array<glm::vec3, 8> here;
    for (unsigned i = 0; i < 8; ++i)
      here[i] = in_face(face, {i & 1 ? where.max.x : where.min.x, i & 2 ? where.max.y : where.min.y,
                               i & 4 ? where.max.z : where.min.z});
    const auto bounds = bounds_of(face, here);
    if (bounds && sees(face, {codes, blocks_of(face)}, *bounds, nullptr)) return true;
    codes += blocks_of(face);
  }
  return false;
}

std::vector<std::uint8_t> touched_faces::encode() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(sizeof(std::uint64_t) + faces_.size() * sizeof(touched_face) + codes_.size());
  put_number(bytes, static_cast<std::uint64_t>(faces_.size()));
  for (const touched_face& face : faces_) put_number(bytes, face);
  bytes.insert(bytes.end(), codes_.begin(), codes_.end());
  return bytes;
}

std::optional<touched_faces> touched_faces::decode(std::span<const std::uint8_t> bytes) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof(count)) return std::nullopt;
  std::memcpy(&count, bytes.data(), sizeof(count));
  bytes = bytes.subspan(sizeof(count));
  if (count > bytes.size() / sizeof(touched_face)) return std::nullopt;
  touched_faces read;
  read.faces_.resize(static_cast<std::size_t>(count));
  std::memcpy(read.faces_.data(), bytes.data(), read.faces_.size() * sizeof(touched_face));
  bytes = bytes.subspan(read.faces_.size() * sizeof(touched_face));
  std::uint64_t left = bytes.size();
  for (const touched_face& face : read.faces_) {
    constexpr std::uint32_t most = 1 << 14;
    if (face.columns > most || face.rows > most || blocks_of(face) > left || !(face.step > 0.0f)) return std::nullopt;
    left -= blocks_of(face);
  }
  if (left != 0) return std::nullopt;
  read.codes_.assign(bytes.begin(), bytes.end());
  return read;
}

}  // namespace sightcell::bake
