#include "stream/instance_attributes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <string_view>

namespace sightcell::bake {
namespace {

constexpr double few_roundings = 4e-7;  // of the longest column
constexpr int float_type = 5126;

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? digits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

}  // namespace

std::optional<instance_place> instance_place_of(const draw_matrix& m) {
  glm::dmat3 linear(1.0);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) linear[c][r] = static_cast<double>(m[static_cast<std::size_t>(3 * c + r)]);
  glm::dmat3 turn = linear;
  glm::dvec3 scale(1.0);
  for (int c = 0; c < 3; ++c) {
    scale[c] = glm::length(linear[c]);
    if (!(scale[c] > 0.0) || !std::isfinite(scale[c])) return std::nullopt;
    turn[c] /= scale[c];
  }
  glm::dquat rotation = glm::normalize(glm::quat_cast(turn));
  if (rotation.w < 0.0) rotation = -rotation;
  instance_place out;
  out.translation = {m[9], m[10], m[11]};
  out.rotation = glm::quat(rotation);
  out.scale = glm::vec3(scale);
  const glm::dmat3 made = glm::mat3_cast(glm::dquat(out.rotation));
  const double limit = few_roundings * std::max({scale.x, scale.y, scale.z});
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!(std::abs(made[c][r] * static_cast<double>(out.scale[c]) - linear[c][r]) <= limit)) return std::nullopt;
  return out;
}

nlohmann::ordered_json instance_bytes::add(const std::vector<instance_place>& places, std::size_t view,
                                           nlohmann::ordered_json& accessors) {
  std::vector<float> translations, rotations, scales;
  for (const instance_place& p : places) {
    translations.insert(translations.end(), {p.translation.x, p.translation.y, p.translation.z});
    rotations.insert(rotations.end(), {p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w});
    scales.insert(scales.end(), {p.scale.x, p.scale.y, p.scale.z});
  }
  nlohmann::ordered_json attributes;
  attributes["TRANSLATION"] = add_column(translations, 3, view, accessors);
  if (std::any_of(places.begin(), places.end(), [](const auto& p) { return p.rotation != glm::quat(1, 0, 0, 0); }))
    attributes["ROTATION"] = add_column(rotations, 4, view, accessors);
  if (std::any_of(scales.begin(), scales.end(), [](float s) { return s != 1.0f; }))
    attributes["SCALE"] = add_column(scales, 3, view, accessors);
  return {{"EXT_mesh_gpu_instancing", {{"attributes", std::move(attributes)}}}};
}

nlohmann::ordered_json instance_bytes::add_column(const std::vector<float>& values, std::size_t width, std::size_t view,
                                                  nlohmann::ordered_json& accessors) {
  nlohmann::ordered_json accessor{{"bufferView", view}};
  if (!bytes_.empty()) accessor["byteOffset"] = bytes_.size();
  accessor["componentType"] = float_type;
  accessor["count"] = values.size() / width;
  accessor["type"] = width == 3 ? "VEC3" : "VEC4";
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8) bytes_.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

std::string instance_bytes::data_uri() const {
  return "data:application/octet-stream;base64," + base64(bytes_);
}

}  // namespace sightcell::bake
