// Reads a scene, says what is in it, and is told that a setting is wrong. Given a second file it bakes, which needs
// OpenGL; naming the call is enough to link all of the bake half.
#include <sightcell/bake/bake.h>
#include <sightcell/bake/settings.h>
#include <sightcell/base/error.h>
#include <sightcell/scene/scene.h>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  try {
    const auto scene = sightcell::scene::load_gltf(argv[1]);
    std::printf("polygons %u\n", static_cast<unsigned>(scene.polygon_count));
    sightcell::bake::settings how;
    how.samples = 8;
    how.cell_limit = 1;
    if (argc > 2) {
      const auto done = sightcell::bake::bake(scene, how, argv[2], true, {});
      std::printf("cells %u\n", static_cast<unsigned>(done.cells));
    }
    how.samples = 1;
    sightcell::bake::validate(how);
  } catch (const sightcell::error& e) {
    std::printf("%s\n", e.what());
    return 0;
  }
  return 1;
}
