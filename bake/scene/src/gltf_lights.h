#pragma once
// Point and spot lights of KHR_lights_punctual. They decide no visibility, so a wrong one does not refuse the file: it
// is left out, or has the widest range and cone. Directional lights are left out without a warning.
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "json_object.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct light_shape {
  float range = std::numeric_limits<float>::infinity();  // as in scene::light
  float cone = 0.0f;
};

struct light_list {
  std::vector<std::optional<light_shape>> of_node;  // by glTF node number
  std::vector<std::string> warnings;                // one line each
};

// Reads the lights of a checked document. Never throws for what a light has.
light_list read_lights(const json_object& root);

// Adds the light of a node to s.lights. One at no finite place adds a light warning instead.
void add_light(scene& s, std::uint32_t node, const light_shape& shape, const glm::dmat4& to_world, bool moves);

}  // namespace sightcell::scene
