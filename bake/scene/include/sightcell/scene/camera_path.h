#pragma once
// The paths of cameras that the animations of a glTF file move. scene.h has the conventions.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace sightcell::scene {

// Positions in world space, in the order of time; straight between them. One or more.
using point_path = std::vector<std::array<float, 3>>;

// Reads the paths of a camera: one for each animation that moves it or a node above it, two or more where it jumps (a
// sampler with STEP). Every keyframe is a point; between two keyframes there are more where the path is not straight.
// path: .glb or .gltf.
// camera: the name of a node, or of the camera of a node. Of all nodes with that name.
// Fails with scene.no-such-camera, scene.camera-at-rest if no animation moves it, and with scene.* for a broken file.
// Cost: reads the whole file, and decodes the keyframes of these nodes only.
std::vector<point_path> camera_paths(const std::filesystem::path& path, const std::string& camera);

}  // namespace sightcell::scene
