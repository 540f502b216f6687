// What a C++ host writes: prints how many polygons are seen from the middle of every cell.
#include <array>
#include <cstdio>
#include <sightcell/sightcell.hpp>
#include <utility>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  auto file = sightcell::db::open_file(argv[1]);
  if (file.status() != SIGHTCELL_OK) return 1;
  auto camera = sightcell::view::create(*file);
  if (camera.status() != SIGHTCELL_OK) return 1;
  for (std::uint32_t cell = 0; cell < (*file).cell_count(); ++cell) {
    const auto box = (*file).cell_box(cell);
    if (box.status() != SIGHTCELL_OK) return 1;
    std::array<float, 3> eye{};
    for (std::size_t axis = 0; axis < 3; ++axis) eye[axis] = 0.5f * ((*box).min[axis] + (*box).max[axis]);
    sightcell_frame frame{};
    if ((*camera).move(eye, frame) != SIGHTCELL_OK) return 1;
    std::printf("cell %u: %u\n", static_cast<unsigned>(cell), static_cast<unsigned>(frame.polygon_count));
  }
  return 0;
}
