#pragma once
// Levels of detail of objects as a host draws them: one level of each object, which the distance of the camera chooses
// (docs/levels.md). A scene has draws of the levels in its tree; load_gltf leaves out those outside it, as in most
// files with MSFT_lod. scene.h has the conventions.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Where a coarser level takes the place of finer ones. A level without either is never chosen.
struct level_switch {
  std::optional<float> from_distance{};   // meters between the camera and the center of the object
  std::optional<float> below_coverage{};  // diameter of the object by the height of the picture (MSFT_screencoverage)
};

// A coarser level of an object.
struct object_level {
  level_switch begins;
  polygon_range polygons;  // of object_levels::coarser
};

// An object with coarser levels.
struct leveled_object {
  std::vector<std::uint32_t> finest;  // its draws of level 0, in scene::draws
  std::vector<object_level> coarser;  // those with polygons, finer ones first
  float least_coverage = 0.0f;        // below it nothing of the object is drawn (MSFT_screencoverage)
};

struct object_levels {
  scene coarser;  // the draws of all coarser levels, as if they were a scene of their own; without warnings
  std::vector<leveled_object> objects;
};

// Reads the coarser levels of a file, in the tree of the scene and outside it. Levels outside are placed as their
// objects are: below the same parent.
// path, scene_index: as for load_gltf.
// s: what load_gltf returned for them.
// Fails as load_gltf.
// Cost: that of load_gltf, with all levels.
object_levels load_object_levels(const std::filesystem::path& path, const scene& s, int scene_index = -1);

}  // namespace sightcell::scene
