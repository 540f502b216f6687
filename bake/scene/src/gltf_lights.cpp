#include "gltf_lights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

namespace sightcell::scene {
namespace {

constexpr double widest_cone = std::numbers::pi / 2.0;
constexpr double default_cone = std::numbers::pi / 4.0;  // of a spot light that states none

// Null where there is no such member.
const nlohmann::json* inner(const nlohmann::json* of, const char* key) {
  if (of == nullptr || !of->is_object()) return nullptr;
  const auto found = of->find(key);
  return found == of->end() ? nullptr : &*found;
}

const nlohmann::json* lights_of(const nlohmann::json* extensions) {
  return inner(extensions, "KHR_lights_punctual");
}

float range_of(const nlohmann::json& light, const std::string& where, std::vector<std::string>& warnings) {
  const nlohmann::json* const range = inner(&light, "range");
  if (range == nullptr) return light_shape{}.range;
  // Infinity where a float cannot have the number.
  const float value = range->is_number() ? static_cast<float>(range->get<double>()) : 0.0f;
  if (value > 0.0f) return value;
  warnings.push_back(where + " has a range that is not a number above 0: it has no limit");
  return light_shape{}.range;
}

float cone_of(const nlohmann::json& light, const std::string& where, std::vector<std::string>& warnings) {
  const nlohmann::json* const spot = inner(&light, "spot");
  const nlohmann::json* const angle = inner(spot, "outerConeAngle");
  if (angle == nullptr) return static_cast<float>(default_cone);
  const double value = angle->is_number() ? angle->get<double>() : 0.0;
  // Some exporters round the widest angle up.
  if (value > 0.0 && value <= widest_cone + 1e-3) return static_cast<float>(std::min(value, widest_cone));
  warnings.push_back(where + " has an outerConeAngle that is not above 0 and at most pi / 2: it shines everywhere");
  return 0.0f;
}

std::optional<light_shape> shape_of(const nlohmann::json& light, const std::string& where,
                                    std::vector<std::string>& warnings) {
  const nlohmann::json* const type = inner(&light, "type");
  const std::string kind = type != nullptr && type->is_string() ? type->get<std::string>() : std::string();
  if (kind == "directional") return std::nullopt;
  if (kind != "point" && kind != "spot") {
    warnings.push_back(where + " has the unknown type \"" + printable(kind) + "\": it is left out");
    return std::nullopt;
  }
  light_shape shape;
  shape.range = range_of(light, where, warnings);
  if (kind == "spot") shape.cone = cone_of(light, where, warnings);
  return shape;
}

}  // namespace

light_list read_lights(const json_object& root) {
  const std::vector<json_object> nodes = root.objects("nodes");
  light_list out;
  out.of_node.resize(nodes.size());
  const nlohmann::json* const list = inner(lights_of(root.raw("extensions")), "lights");
  if (list == nullptr || !list->is_array()) return out;
  std::vector<std::optional<light_shape>> shapes;
  for (const nlohmann::json& light : *list) {
    const std::string where = "extensions.KHR_lights_punctual.lights[" + std::to_string(shapes.size()) + "]";
    shapes.push_back(shape_of(light, where, out.warnings));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const nlohmann::json* const use = lights_of(nodes[i].raw("extensions"));
    if (use == nullptr) continue;
    const nlohmann::json* const number = inner(use, "light");
    if (number != nullptr && number->is_number_unsigned() && number->get<std::uint64_t>() < shapes.size())
      out.of_node[i] = shapes[number->get<std::size_t>()];
    else
      out.warnings.push_back(nodes[i].where() + " refers to a light that the file does not have: it is left out");
  }
  return out;
}

void add_light(scene& s, std::uint32_t node, const light_shape& shape, const glm::dmat4& to_world, bool moves) {
  const glm::dvec3 at(to_world[3]);
  const glm::dvec3 along = -glm::dvec3(to_world[2]);
  const double length = glm::length(along);
  light one{.node = node, .direction = {0.0f, 0.0f, -1.0f}, .range = shape.range, .cone = shape.cone, .moves = moves};
  const bool has_direction = std::isfinite(length) && length > 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    one.position[k] = static_cast<float>(at[axis]);
    if (has_direction) one.direction[k] = static_cast<float>(along[axis] / length);
    if (std::isfinite(one.position[k])) continue;
    s.light_warnings.push_back("the light of nodes[" + std::to_string(node) +
                               "] is at no finite place: it is left out");
    return;
  }
  if (!has_direction && one.cone > 0.0f) {
    one.cone = 0.0f;
    s.light_warnings.push_back("the spot light of nodes[" + std::to_string(node) +
                               "] has no direction: it shines everywhere");
  }
  s.lights.push_back(one);
}

}  // namespace sightcell::scene
