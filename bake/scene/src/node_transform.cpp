#include "node_transform.h"

namespace sightcell::scene {

glm::dmat4 from_trs(const double* t, const double* q, const double* s) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  // Not normalized: a scaled quaternion scales, as in every reader that uses this formula.
  return {glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0) * s[0],
          glm::dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0) * s[1],
          glm::dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0) * s[2],
          glm::dvec4(t[0], t[1], t[2], 1)};
}

}  // namespace sightcell::scene
