#pragma once
// A sketch of a glTF file, written and loaded.
#include <gtest/gtest.h>

#include <string>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

inline scene load(const gltf_sketch& sketch) {
  const temporary_folder folder;
  return load_gltf(folder.write("sketch.glb", sketch.glb()));
}

// The id of the error that refuses it: bad input, in one line. "none" where it loads.
inline std::string refusal(const gltf_sketch& sketch) {
  try {
    (void)load(sketch);
  } catch (const error& e) {
    EXPECT_EQ(e.kind(), error_kind::bad_input);
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.id();
  }
  return "none";
}

}  // namespace sightcell::scene
