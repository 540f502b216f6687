// The import behind one exported function, as an engine's plugin would have it.
#include "shared_scene.h"

#include <cstdio>

#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

unsigned polygons_of(const char* path) {
  try {
    return sightcell::scene::load_gltf(path).polygon_count;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 0;
  }
}
