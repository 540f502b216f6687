#pragma once
// What in a file refers to triangles by their numbers.
#include <set>
#include <string>

#include "gltf_accessors.h"
#include "json_object.h"

namespace sightcell::scene {

// Returns whether something may refer to triangles of a primitive, or to its vertices in an order of their own, so that
// triangles must keep their numbers: an extension, or an attribute that is not in the primitive's Draco stream.
// mesh, primitive: of the file that table is about.
// extensions: receives the names of extensions that may.
// Throws sightcell::error (bad_input).
bool refers_to_triangles(const json_object& mesh, const json_object& primitive, const accessor_table& table,
                         std::set<std::string>& extensions);

}  // namespace sightcell::scene
