// dump_triangles SCENE OUT: the corners of all polygons in world space, by source id: nine 32-bit floats each, as they lie
// in memory. For programs that compare scenes.
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>

#include "sightcell/scene/scene.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: dump_triangles SCENE OUT\n");
    return 2;
  }
  try {
    using namespace sightcell;
    const scene::world_geometry world = scene::flatten(scene::load_gltf(argv[1]));
    std::ofstream out(argv[2], std::ios::binary);
    for (const std::uint32_t index : world.indices)
      out.write(reinterpret_cast<const char*>(&world.positions[index]), sizeof(world.positions[index]));
    out.close();
    if (!out) throw std::runtime_error("cannot write the file");
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
