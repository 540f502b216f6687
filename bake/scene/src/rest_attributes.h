#pragma once
// Normals and tangents under a transform, and the attributes of a primitive in its rest pose.
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "gltf_attributes.h"
#include "import_scene.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

inline constexpr glm::vec3 any_normal(0, 1, 0), any_tangent(1, 0, 0);  // in place of vectors without a direction

void put_vec3(std::vector<float>& values, std::size_t at, const glm::vec3& v);

// Normals are transformed by the inverse transpose. The matrix of cofactors equals it except for the length, and
// exists for a scale of 0 too.
struct direction_map {
  explicit direction_map(const glm::dmat3& m);
  glm::vec3 normal(const glm::vec3& n) const;
  glm::vec3 tangent(const glm::vec3& t) const;

  glm::dmat3 matrix, cofactors;
  bool mirrored;
};

// normals: three numbers per vertex. tangents: four.
void turn_normal(const direction_map& map, std::vector<float>& normals, std::size_t vertex);
void turn_tangent(const direction_map& map, std::vector<float>& tangents, std::size_t vertex);

// Returns normals: a corner of a single polygon gets the polygon's normal, others the mean of their polygons'
// weighted by area.
std::vector<float> normals_of(const geometry& g);

// Returns the attributes of a draw's primitive in its rest pose.
// values: as in the file.
attribute_values attributes_at_rest(const scene& s, const pose_list& poses, gltf_attributes& attributes, const draw& d,
                                    attribute_values values);

}  // namespace sightcell::scene
