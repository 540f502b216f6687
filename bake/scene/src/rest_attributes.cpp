#include "rest_attributes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sightcell::scene {
namespace {

glm::vec3 vec3_at(const std::vector<float>& values, std::size_t at) {
  return {values[at], values[at + 1], values[at + 2]};
}

// Returns a unit vector, or `otherwise` if v has no direction: readers would reject zeros.
glm::vec3 direction(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

void displace(std::vector<float>& values, std::uint32_t width, const std::vector<float>& by, double weight) {
  for (std::size_t i = 0; 3 * i + 2 < by.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      values[width * i + k] =
          static_cast<float>(static_cast<double>(values[width * i + k]) + weight * static_cast<double>(by[3 * i + k]));
}

}  // namespace

void put_vec3(std::vector<float>& values, std::size_t at, const glm::vec3& v) {
  values[at] = v.x, values[at + 1] = v.y, values[at + 2] = v.z;
}

direction_map::direction_map(const glm::dmat3& m) : matrix(m), mirrored(glm::determinant(m) < 0.0) {
  const double sign = mirrored ? -1.0 : 1.0;
  cofactors = {sign * glm::cross(m[1], m[2]), sign * glm::cross(m[2], m[0]), sign * glm::cross(m[0], m[1])};
}

glm::vec3 direction_map::normal(const glm::vec3& n) const {
  return direction(cofactors * glm::dvec3(n), any_normal);
}

glm::vec3 direction_map::tangent(const glm::vec3& t) const {
  return direction(matrix * glm::dvec3(t), any_tangent);
}

void turn_normal(const direction_map& map, std::vector<float>& normals, std::size_t vertex) {
  put_vec3(normals, 3 * vertex, map.normal(vec3_at(normals, 3 * vertex)));
}

void turn_tangent(const direction_map& map, std::vector<float>& tangents, std::size_t vertex) {
  put_vec3(tangents, 4 * vertex, map.tangent(vec3_at(tangents, 4 * vertex)));
  if (map.mirrored) tangents[4 * vertex + 3] = -tangents[4 * vertex + 3];
}

std::vector<float> normals_of(const geometry& g) {
  std::vector<glm::dvec3> sums(g.positions.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    const glm::dvec3 a(g.positions[g.indices[i]]);
    const glm::dvec3 n =
        glm::cross(glm::dvec3(g.positions[g.indices[i + 1]]) - a, glm::dvec3(g.positions[g.indices[i + 2]]) - a);
    for (std::size_t k = 0; k < 3; ++k) sums[g.indices[i + k]] += n;
  }
  std::vector<float> out(3 * sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) put_vec3(out, 3 * i, direction(sums[i], any_normal));
  return out;
}

attribute_values attributes_at_rest(const scene& s, const pose_list& poses, gltf_attributes& attributes, const draw& d,
                                    attribute_values values) {
  const auto posed = poses.find(d.geometry);
  if (posed == poses.end()) return values;
  const rest_pose& rest = posed->second;
  const std::size_t vertices = s.geometries[d.geometry].positions.size();
  const auto normal = values.find("NORMAL");
  const auto tangent = values.find("TANGENT");
  for (std::size_t i = 0; i < rest.weights.size(); ++i) {
    if (rest.weights[i] == 0.0) continue;
    const auto add = [&](const char* name, std::uint32_t width, std::vector<float>& to) {
      displace(to, width, attributes.displacements(d.mesh, d.primitive, i, name, vertices), rest.weights[i]);
    };
    if (normal != values.end()) add("NORMAL", 3, normal->second);
    if (tangent != values.end()) add("TANGENT", 4, tangent->second);
  }
  for (std::size_t i = 0; i < rest.frames.size(); ++i) {
    const direction_map frame(rest.frames[i]);
    if (normal != values.end()) turn_normal(frame, normal->second, i);
    if (tangent != values.end()) turn_tangent(frame, tangent->second, i);
  }
  return values;
}

}  // namespace sightcell::scene
