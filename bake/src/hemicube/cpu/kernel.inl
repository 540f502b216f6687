// Defines the kernel for the instruction set that the including file is compiled for. That file defines the names
// SIGHTCELL_KERNEL and SIGHTCELL_KERNEL_NAME first.
//
// The rule for kernel files: they contain no function that other files share, such as an inline function of a library.
// The linker keeps one copy of a shared function, and with the wrong copy a processor would run instructions that it
// does not have. tests/unit/bake checks the object files.
#include "hemicube/cpu/gather.h"
#include "hemicube/cpu/traversal.h"

namespace sightcell::bake::cpu {
namespace {

void draw(const scene_view& scene, const face_frame& face, const tile_image& image, const polygon_counter& counter) {
  clear(image);
  draw_state s{face, image, counter, scene};
  draw_tree<pass::opaque>(s, scene.opaque);
  draw_tree<pass::masked>(s, scene.masked);
  draw_tree<pass::see_through>(s, scene.see_through);
}

void add_importance(const face_frame& face, const tile_image& image, float far_plane, importance_sums& sums) {
  importance_walk(face, image, far_plane, sums).run();
}

}  // namespace

extern const kernel SIGHTCELL_KERNEL;
const kernel SIGHTCELL_KERNEL{SIGHTCELL_KERNEL_NAME, draw, gather_face, add_importance};

}  // namespace sightcell::bake::cpu
