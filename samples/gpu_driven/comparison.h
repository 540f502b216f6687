#pragma once
// Compares the picture of a mode with that of everything, and counts clusters, on the device.
#include <array>
#include <cstdint>

#include "gl_objects.h"
#include "renderer.h"
#include "sightcell/picture/gl_program.h"

namespace gpu_driven {

// Of one picture. tally.comp has the same order.
struct tally {
  std::uint32_t wrong_pixels = 0;     // another place, or other blended polygons before it
  std::uint32_t ties = 0;             // another color in the same place: of surfaces that coincide, another is in front
  std::uint32_t clusters = 0;         // drawn
  std::uint32_t triangles = 0;        // of them
  std::uint32_t clusters_in_set = 0;  // drawn, and in the PVS
  std::uint32_t seen = 0;             // with pixels in the picture of everything
  std::uint32_t seen_in_set = 0;      // of them in the PVS
  std::uint32_t missed = 0;           // seen and not drawn
  std::uint32_t missed_with_wrong = 0;  // of them with a wrong pixel: others coincide with what was drawn
  std::uint32_t differing = 0;          // pixels of another color, at any place
  std::uint32_t difference = 0;         // of colors, in 1/255 of a component: the sum over pixels
};
static_assert(sizeof(tally) == 11 * sizeof(std::uint32_t));

class comparison {
 public:
  comparison(const host_scene& host, const renderer& draws);

  // After the picture of everything.
  void begin_frame() const;

  // After the picture of a mode. bits: of the PVS.
  void add(draw_mode mode, const gl_buffer& bits) const;

  // Waits for the device.
  std::array<tally, mode_count> read() const;

 private:
  const renderer& draws_;
  std::uint32_t cluster_count_;
  gl_buffer tallies_, wrong_in_;
  sightcell::picture::gl_program seen_, compare_, tally_;
};

}  // namespace gpu_driven
