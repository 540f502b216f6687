#pragma once
// The import itself, for load_gltf and for code that needs more of a file than a scene has.
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <map>
#include <string>
#include <vector>

#include "gltf_file.h"
#include "lod_levels.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// How a geometry was brought into its rest pose.
struct rest_pose {
  std::vector<double> weights;     // of morph targets
  std::vector<glm::dmat3> frames;  // per vertex: the transform of directions by its joints; empty: no skin
};

using pose_list = std::map<std::uint32_t, rest_pose>;  // by geometry; without those that are as in their mesh

// Converts a glTF file to a scene and calls finish.
// name: of the scene.
// poses: receives the rest poses; may be null.
// switches: receives where levels of detail begin, by object; may be null.
// outside: whether levels outside the tree are in the scene too.
// Throws sightcell::error.
scene import_gltf(gltf_file file, const gltf_source& source, std::string name, int scene_index,
                  pose_list* poses = nullptr, std::vector<object_switches>* switches = nullptr, bool outside = false);

// Throws the error for a std::bad_alloc during an import.
[[noreturn]] void refuse_for_memory(const std::string& file);

}  // namespace sightcell::scene
