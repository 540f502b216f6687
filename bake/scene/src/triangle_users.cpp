#include "triangle_users.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "gltf_attributes.h"

namespace sightcell::scene {
namespace {

// Extensions of primitives that refer to no triangle and no vertex by number.
constexpr std::array<std::string_view, 4> separable_extensions = {
    "EXT_mesh_features", "EXT_structural_metadata", "KHR_draco_mesh_compression", "KHR_materials_variants"};

}  // namespace

bool refers_to_triangles(const json_object& mesh, const json_object& primitive, const accessor_table& table,
                         std::set<std::string>& extensions) {
  bool refers = false;
  const auto add = [&](const std::string& name) {
    extensions.insert(name);
    refers = true;
  };
  if (const auto of_mesh = mesh.object("extensions"))
    for (const std::string& name : of_mesh->keys()) add(name);
  if (const auto of_primitive = primitive.object("extensions"))
    for (const std::string& name : of_primitive->keys())
      if (std::find(separable_extensions.begin(), separable_extensions.end(), name) == separable_extensions.end())
        add(name);
  const json_object attributes = primitive.required_object("attributes");
  if (const auto draco = draco_of(primitive, attributes, table)) {
    const json_object ids = draco->required_object("attributes");
    for (const std::string& name : attributes.keys()) refers = refers || !ids.has(name.c_str());
  }
  return refers;
}

}  // namespace sightcell::scene
