#pragma once
// The import proper, for load_gltf and for who brings over more of a file than a scene holds.
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <map>
#include <string>
#include <vector>

#include "gltf_file.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// How a geometry came into the pose that it rests in.
struct rest_pose {
  std::vector<double> weights;     // of morph targets
  std::vector<glm::dmat3> frames;  // by vertex, what its joints do to directions; empty: no skin
};

using pose_list = std::map<std::uint32_t, rest_pose>;  // by geometry; those that are as their mesh has them are missing

// name: that of the scene. poses: where to put them; null: nowhere. Throws sightcell::error.
scene import_gltf(gltf_file file, const gltf_source& source, std::string name, int scene_index,
                  pose_list* poses = nullptr);

// What to say when std::bad_alloc ends an import.
[[noreturn]] void refuse_for_memory(const std::string& file);

}  // namespace sightcell::scene
