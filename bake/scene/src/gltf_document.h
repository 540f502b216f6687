#pragma once
// glTF's JSON, checked. Files are hostile: tinygltf drops a primitive that it cannot parse (and so would shift source
// ids), allocates what a file asks for and follows any URI. It is therefore given a document of our own making that
// holds only what the import uses, each value checked for type, range and against the bytes that are really there.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "accessor.h"
#include "gltf_file.h"
#include "gltf_materials.h"
#include "gltf_nodes.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct gltf_document {
  std::string json;                                // for tinygltf; its accessors are stubs
  std::vector<accessor_view> accessors;            // what they hold, by number
  std::vector<std::vector<std::uint8_t>> buffers;  // what they point into
  std::vector<material> materials;
  std::vector<texture_coordinates> coordinates;  // by material; TEXCOORD_0 of json is already the set that they name
  std::vector<image> images;
  node_list nodes;
  std::vector<extension_use> extensions;
  std::vector<std::string> warnings;
};

// Throws sightcell::error (bad_input).
gltf_document read_gltf_document(gltf_file file, const gltf_source& source);

}  // namespace sightcell::scene
