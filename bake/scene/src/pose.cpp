#include "pose.h"

#include <algorithm>

namespace sightcell::scene {

void displace(std::vector<glm::dvec3>& positions, std::span<const float> by, double weight) {
  const std::size_t count = std::min(positions.size(), by.size() / 3);
  for (std::size_t i = 0; i < count; ++i) positions[i] += weight * glm::dvec3(by[3 * i], by[3 * i + 1], by[3 * i + 2]);
}

std::optional<std::size_t> bend(std::vector<glm::dvec3>& positions, std::span<const influence_set> sets,
                                std::span<const glm::dmat4> matrices, std::vector<glm::dmat3>* frames) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    double sum = 0.0;
    for (const influence_set& set : sets)
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) sum += set.weights[k];
    const bool weighted = sum > 0.0;  // not if one is NaN
    glm::dvec4 bent(0.0);
    glm::dmat3 frame(0.0);
    for (const influence_set& set : sets) {
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
        const double weight = weighted ? set.weights[k] / sum : (&set == sets.data() && k == 4 * i ? 1.0 : 0.0);
        if (weight == 0.0) continue;
        const float joint = set.joints[k];
        if (!(joint >= 0.0f && joint < static_cast<float>(matrices.size()))) return i;
        const glm::dmat4& matrix = matrices[static_cast<std::size_t>(joint)];
        bent += weight * (matrix * glm::dvec4(positions[i], 1.0));
        if (frames != nullptr) frame += weight * glm::dmat3(matrix);
      }
    }
    positions[i] = glm::dvec3(bent);
    if (frames != nullptr) frames->push_back(frame);
  }
  return std::nullopt;
}

}  // namespace sightcell::scene
