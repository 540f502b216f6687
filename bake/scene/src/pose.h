#pragma once
// Vertices in the rest pose of a file: displaced by morph targets, bent by the joints of a skin.
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace sightcell::scene {

// by: x, y, z per vertex.
void displace(std::vector<glm::dvec3>& positions, std::span<const float> by, double weight);

// JOINTS_n and WEIGHTS_n: four of each per vertex.
struct influence_set {
  std::vector<float> joints, weights;
};

// Transforms positions by the joints of a skin. Weights are divided by their sum; a vertex without weights follows
// its first joint.
// matrices: by joint, from the mesh's space to the world.
// frames: receives the transform of directions per vertex; may be null.
// Returns the number of a vertex whose joint does not exist, after which positions are unusable; else nothing.
std::optional<std::size_t> bend(std::vector<glm::dvec3>& positions, std::span<const influence_set> sets,
                                std::span<const glm::dmat4> matrices, std::vector<glm::dmat3>* frames = nullptr);

}  // namespace sightcell::scene
