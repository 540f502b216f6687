// sightcell-test-reference-picture SCENE OUT.png WIDTH HEIGHT EX EY EZ FX FY FZ: the scene as sightcell::picture draws
// it, from an eye along a direction, for comparison with what the viewer draws.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"

int main(int argc, char** argv) {
  if (argc != 11) {
    std::fprintf(stderr, "usage: sightcell-test-reference-picture SCENE OUT.png WIDTH HEIGHT EX EY EZ FX FY FZ\n");
    return 2;
  }
  const auto number = [&](int i) { return std::strtof(argv[i], nullptr); };
  try {
    const sightcell::scene::scene s = sightcell::scene::load_gltf(argv[1]);
    const sightcell::scene::world_geometry world = sightcell::scene::flatten(s);
    const sightcell::picture::gl_context context;
    sightcell::picture::renderer renderer(context, s, world);
    const sightcell::picture::camera camera{.eye = {number(5), number(6), number(7)},
                                            .forward = {number(8), number(9), number(10)}};
    sightcell::picture::write_png(argv[2], renderer.draw(camera, static_cast<std::uint32_t>(std::atoi(argv[3])),
                                                         static_cast<std::uint32_t>(std::atoi(argv[4]))));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
