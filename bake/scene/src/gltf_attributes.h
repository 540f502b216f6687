#pragma once
// Reads vertex attributes other than positions from the checked JSON, for packed files. The import itself reads only
// what decides visibility.
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "draco_decode.h"
#include "gltf_accessors.h"
#include "json_object.h"

namespace sightcell::scene {

using attribute_values = std::map<std::string, std::vector<float>>;  // by name
using attribute_widths = std::map<std::string, std::uint32_t>;       // numbers per vertex, by name

// Returns the Draco stream that the triangles of a primitive are read from. Chooses like the import: a file may contain
// the same triangles uncompressed too.
// attributes: of the primitive, with POSITION.
std::optional<json_object> draco_of(const json_object& primitive, const json_object& attributes,
                                    const accessor_table& table);

class gltf_attributes {
 public:
  // Both must outlive the object.
  gltf_attributes(const json_object& root, accessor_table& table);

  // Returns those of NORMAL, TANGENT, TEXCOORD_n and COLOR_n that a primitive has. Other attributes do not affect how
  // it looks at rest.
  attribute_widths widths(std::uint32_t mesh, std::uint32_t primitive) const;
  // Returns them with their values, width numbers per vertex: normalized integers as floats, numbers that are not
  // finite as 0. Throws sightcell::error (bad_input), also if the file has another number of vertices.
  attribute_values read(std::uint32_t mesh, std::uint32_t primitive, std::size_t vertex_count);
  // Returns what a morph target adds to NORMAL or TANGENT, three numbers per vertex; empty: nothing.
  std::vector<float> displacements(std::uint32_t mesh, std::uint32_t primitive, std::size_t target, const char* name,
                                   std::size_t vertex_count);

 private:
  const json_object& primitive_of(std::uint32_t mesh, std::uint32_t primitive) const;
  std::vector<float> numbers(const json_object& user, std::uint32_t accessor, const std::string& what, const char* type,
                             std::size_t vertex_count);
  const attribute_values& decoded(const json_object& draco, const attribute_widths& widths);

  accessor_table& table_;
  std::vector<json_object> meshes_;
  mutable std::pair<std::uint32_t, std::vector<json_object>> primitives_{UINT32_MAX, {}};  // of the mesh requested last
  std::map<std::string, attribute_values>
      decoded_;  // by Draco's view and attributes, as text: primitives share streams
};

}  // namespace sightcell::scene
