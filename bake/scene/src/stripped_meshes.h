#pragma once
// Removes triangles from the meshes of a document, or puts them in another order.
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gltf_accessors.h"
#include "json_object.h"

namespace sightcell::scene {

// The triangles of a primitive that stay.
struct chosen_triangles {
  std::uint32_t count = 0;                // of the primitive in the file
  std::vector<std::uint32_t> order;       // those that stay, by their new number; each once
  std::vector<std::uint32_t> clusters{};  // by new number, for extras.sightcell.clusters; empty: without
};

// By mesh and primitive. Primitives that are not listed stay as they are.
using kept_triangles = std::map<std::pair<std::uint32_t, std::uint32_t>, chosen_triangles>;

// The elements of accessors that a document has and its file does not, tightly packed; by number in the document.
using added_accessors = std::map<std::size_t, std::vector<std::uint8_t>>;

// Writes the triangles that stay in their new order, and removes primitives and meshes without any. Nodes of such
// meshes stay, without what needs a mesh. Changed primitives are lists of triangles without compression. Vertices go
// with the last triangle of all primitives that have the same vertices, unless one of these has morph targets.
// document: changed; a copy of what root is the checked access of. Meshes are numbered anew, accessors are not.
// Returns the new accessors.
// Throws sightcell::error (bad_input).
added_accessors strip_meshes(nlohmann::json& document, const json_object& root, accessor_table& table,
                             const kept_triangles& kept);

// Returns the number of the mesh that a pointer of KHR_animation_pointer names, and the text after it; nothing if it
// names none.
std::optional<std::pair<std::size_t, std::string>> mesh_of_pointer(const nlohmann::json& pointer);

}  // namespace sightcell::scene
