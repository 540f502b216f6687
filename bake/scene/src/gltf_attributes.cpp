#include "gltf_attributes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "accessor.h"
#include "gltf_numbers.h"

namespace sightcell::scene {
namespace {

bool is_numbered(std::string_view name, std::string_view family) {
  if (!name.starts_with(family)) return false;
  const std::string_view digits = name.substr(family.size());
  return !digits.empty() && digits.size() <= 3 &&
         std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_color(std::string_view name) {
  return is_numbered(name, "COLOR_");
}

// Returns the numbers per vertex that glTF gives an attribute, for colors the smaller of two; 0: none of the
// attributes here.
std::uint32_t width_of(std::string_view name) {
  if (name == "NORMAL" || is_color(name)) return 3;
  if (name == "TANGENT") return 4;
  return is_numbered(name, "TEXCOORD_") ? 2 : 0;
}

void make_finite(std::vector<float>& values) {
  for (float& v : values)
    if (!std::isfinite(v)) v = 0.0f;
}

}  // namespace

std::optional<json_object> draco_of(const json_object& primitive, const json_object& attributes,
                                    const accessor_table& table) {
  const auto extensions = primitive.object("extensions");
  if (!extensions || !extensions->has("KHR_draco_mesh_compression")) return std::nullopt;
  const std::uint32_t position = attributes.required_index("POSITION", "accessors", table.size());
  if (table.source(position).has("bufferView")) return std::nullopt;
  return extensions->required_object("KHR_draco_mesh_compression");
}

gltf_attributes::gltf_attributes(const json_object& root, accessor_table& table)
    : table_(table), meshes_(root.objects("meshes")) {}

const json_object& gltf_attributes::primitive_of(std::uint32_t mesh, std::uint32_t primitive) const {
  if (primitives_.first != mesh) primitives_ = {mesh, meshes_.at(mesh).objects("primitives")};
  return primitives_.second.at(primitive);
}

attribute_widths gltf_attributes::widths(std::uint32_t mesh, std::uint32_t primitive) const {
  attribute_widths out;
  const json_object& source = primitive_of(mesh, primitive);
  const json_object attributes = source.required_object("attributes");
  const auto draco = draco_of(source, attributes, table_);
  const auto ids = draco ? std::optional(draco->required_object("attributes")) : std::nullopt;
  for (const std::string& name : attributes.keys()) {
    const std::uint32_t width = width_of(name);
    if (width == 0 || (ids && !ids->has(name.c_str()))) continue;
    const std::uint32_t accessor = attributes.required_index(name.c_str(), "accessors", table_.size());
    const bool has_alpha = is_color(name) && table_.source(accessor).text("type") == "VEC4";
    out[name] = has_alpha ? 4 : width;
  }
  return out;
}

attribute_values gltf_attributes::read(std::uint32_t mesh, std::uint32_t primitive, std::size_t vertex_count) {
  const json_object& source = primitive_of(mesh, primitive);
  const json_object attributes = source.required_object("attributes");
  const attribute_widths wanted = widths(mesh, primitive);
  if (wanted.empty()) return {};
  if (const auto draco = draco_of(source, attributes, table_)) {
    const attribute_values& values = decoded(*draco, wanted);
    const auto [name, width] = *wanted.begin();
    if (values.at(name).size() != width * vertex_count)
      draco->fail("scene.draco", "has changed since it was loaded",
                  "run the command again while no other program writes the file");
    return values;
  }
  attribute_values out;
  for (const auto& [name, width] : wanted) {
    const std::uint32_t accessor = attributes.required_index(name.c_str(), "accessors", table_.size());
    out[name] = numbers(attributes, accessor, name, vector_type(width), vertex_count);
  }
  return out;
}

std::vector<float> gltf_attributes::displacements(std::uint32_t mesh, std::uint32_t primitive, std::size_t target,
                                                  const char* name, std::size_t vertex_count) {
  const std::vector<json_object> targets = primitive_of(mesh, primitive).objects("targets");
  if (target >= targets.size()) return {};
  const auto accessor = targets[target].index(name, "accessors", table_.size());
  if (!accessor) return {};
  return numbers(targets[target], *accessor, name, "VEC3", vertex_count);
}

std::vector<float> gltf_attributes::numbers(const json_object& user, std::uint32_t accessor, const std::string& what,
                                            const char* type, std::size_t vertex_count) {
  table_.require(user, accessor, what.c_str(), {type}, {5120, 5121, 5122, 5123, 5126});
  if (table_.count(accessor) != vertex_count)
    user.fail("scene.bad-field",
              "has " + std::to_string(table_.count(accessor)) + " of " + what + " for " + std::to_string(vertex_count) +
                  " positions",
              "export the file again");
  std::vector<float> out;
  if (!read_numbers(table_.elements(accessor), out))
    user.fail(
        "scene.index-out-of-range",
        "takes " + what + " from accessors[" + std::to_string(accessor) + "] with a sparse index beyond its count",
        "export the file again");
  make_finite(out);
  return out;
}

const attribute_values& gltf_attributes::decoded(const json_object& draco, const attribute_widths& widths) {
  const std::uint32_t view = draco.required_index("bufferView", "bufferViews", table_.view_count());
  const json_object ids = draco.required_object("attributes");
  std::vector<draco_wish> wishes;
  std::string key = std::to_string(view);
  for (const auto& [name, width] : widths) {
    const auto id = static_cast<std::uint32_t>(ids.required_number(name.c_str(), UINT32_MAX));
    wishes.push_back({id, width});
    key += " " + name + " " + std::to_string(id);
  }
  const auto known = decoded_.find(key);
  if (known != decoded_.end()) return known->second;
  const std::span<const std::uint8_t> stream = table_.bytes_of_view(view);
  table_.count_compressed(draco, stream.size());
  std::string why_not;
  auto mesh = decode_draco(stream, wishes, why_not);
  if (!mesh) draco.fail("scene.draco", "cannot be decoded: " + printable(why_not), "export the file again");
  attribute_values values;
  std::size_t next = 0;
  for (const auto& [name, width] : widths) {
    make_finite(mesh->attributes[next]);
    values[name] = std::move(mesh->attributes[next++]);
  }
  return decoded_.emplace(std::move(key), std::move(values)).first->second;
}

}  // namespace sightcell::scene
