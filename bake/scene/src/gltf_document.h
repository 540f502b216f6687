#pragma once
// Checks the JSON of a glTF file, which may be hostile. tinygltf skips a primitive that it cannot parse (which would
// shift source ids), allocates what a file requests and follows any URI. So it gets a document that contains only
// what the import uses, each value checked for type, range and against the bytes in the file.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "accessor.h"
#include "gltf_file.h"
#include "gltf_lights.h"
#include "gltf_materials.h"
#include "gltf_nodes.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// The name of the attribute that has the host's clusters in the reduced document.
inline constexpr const char* clusters_attribute = "_SIGHTCELL_CLUSTERS";

// The checked content of a file.
struct gltf_document {
  std::string json;                                // for tinygltf; its accessors are stubs
  std::vector<accessor_view> accessors;            // content by accessor
  std::vector<std::vector<std::uint8_t>> buffers;  // which the accessors point into
  std::vector<material> materials;
  std::vector<texture_coordinates> coordinates;  // by material; TEXCOORD_0 of json is already the set that they name
  std::vector<image> images;
  node_list nodes;
  light_list lights;
  std::vector<extension_use> extensions;
  std::vector<std::string> warnings;
};

// Returns the checked content of a file. Throws sightcell::error (bad_input).
gltf_document read_gltf_document(gltf_file file, const gltf_source& source);

}  // namespace sightcell::scene
