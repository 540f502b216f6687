#pragma once
// Vertices in the pose that a file gives them at rest: displaced by morph targets, bent by the joints of a skin.
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

// matrices: from the mesh's space to the world, by joint. Weights count in proportion to their sum; a vertex without
// any hangs on its first joint. frames: what that does to directions, by vertex; null: nobody asks. A vertex that hangs
// on a joint that is not there comes back; the positions are then of no use.
std::optional<std::size_t> bend(std::vector<glm::dvec3>& positions, std::span<const influence_set> sets,
                                std::span<const glm::dmat4> matrices, std::vector<glm::dmat3>* frames = nullptr);

}  // namespace sightcell::scene
