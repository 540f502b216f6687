#pragma once
// Places of a mesh as EXT_mesh_gpu_instancing has them.
#include <cstddef>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stream/shown_draws.h"

namespace sightcell::bake {

// Turns and scales in floats.
struct instance_place {
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 scale{1.0f};
};

// Returns nothing for a matrix that mirrors, because viewers cull the wrong sides of mirrored instances; and for one
// that turns and scales do not make to within a few roundings of floats.
std::optional<instance_place> instance_place_of(const draw_matrix& m);

// The bytes of all instances of a file: an attribute after the other, in one buffer view.
class instance_bytes {
 public:
  // Adds the attributes of one node, and returns its extension.
  // view: the number of the buffer view. accessors: those of the document; new ones are added.
  nlohmann::ordered_json add(const std::vector<instance_place>& places, std::size_t view,
                             nlohmann::ordered_json& accessors);

  std::size_t size() const { return bytes_.size(); }
  std::string data_uri() const;

 private:
  nlohmann::ordered_json add_column(const std::vector<float>& values, std::size_t width, std::size_t view,
                                    nlohmann::ordered_json& accessors);
  std::vector<std::uint8_t> bytes_;
};

}  // namespace sightcell::bake
