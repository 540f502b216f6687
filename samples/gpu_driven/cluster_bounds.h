#pragma once
// Sphere, box and normal cone of a cluster in world space.
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "gpu_records.h"

namespace gpu_driven {

// Sets sphere, min, max and cone.
// positions: local space. corners: three per triangle. to_world: any, mirrored ones too.
// is_double_sided: the cone never culls.
void set_bounds(cluster_record& out, std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners,
                const glm::dmat4& to_world, bool is_double_sided);

// Returns how much a transform enlarges, at most.
double greatest_scale(const glm::dmat4& to_world);

}  // namespace gpu_driven
