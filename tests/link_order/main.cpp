// Counts the polygons of a plain and a Draco-compressed scene, with libdraco loaded before the import.
#include <cstdio>

#include "shared_scene.h"
#include "unit/scene/draco_sketch.h"

int main() {
  const temporary_folder folder;
  gltf_sketch plain;
  plain.add_node({{"mesh", plain.add_mesh(plain.add_row_of_triangles(3))}});
  const unsigned triangles = polygons_of(folder.write("plain.glb", plain.glb()).c_str());
  const unsigned compressed = polygons_of(folder.write("draco.glb", draco_sketch().glb()).c_str());
  std::printf("%u plain, %u compressed\n", triangles, compressed);
  return triangles == 3 && compressed == 16 ? 0 : 1;
}
