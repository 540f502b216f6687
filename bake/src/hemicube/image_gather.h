#pragma once
// Computes the polygon list and the importance sums of a hemicube on the CPU, for sources that have ids and depths of a
// whole atlas in memory.
//
// Importance of a pixel with d = depth along the face's axis / far plane, at most 1 (background 1):
//   I = 1/d * [ w_r (d(x_r) - d), w_u (d(x_u) - d), w_l (d(x_l) - d), w_d (d(x_d) - d) ], positive parts only,
// neighbors inside the face's own image, w_r = (x + 0.5) / W, w_u = (y + 0.5) / H with y up, w_l = 1 - w_r,
// w_d = 1 - w_u, in image axes of each face.
#include <cstdint>
#include <span>
#include <vector>

#include "hemicube/hemicube_faces.h"
#include "hemicube/hemicube_source.h"

namespace sightcell::bake {

// Scratch memory of one thread: 8 bytes per polygon and a few rows of pixels. It keeps nothing from one hemicube to the
// next.
class image_gather {
 public:
  explicit image_gather(std::uint32_t polygon_count);

  // Adds pixels of a non-occluder, which is not in the image. Call it before list(). first: the first of these pixels.
  void add(std::uint32_t id, std::uint32_t pixels, std::uint32_t first);

  // Lists the polygons. ids: 3 S x S source ids, row by row; scene::no_index in the background. Returns false, with an
  // invalid list, where an id is not below polygon_count.
  bool list(std::span<const std::uint32_t> ids, std::vector<seen_polygon>& seen);
  // Sums the importance. depths: c / depth along the axis of the face, for any constant c; 0 in the background.
  // at_far_plane: c / far plane.
  void sum(std::span<const face_view, face_count> faces, std::span<const float> depths, float at_far_plane,
           std::array<double, 4>& importance);

 private:
  struct count {
    std::uint32_t pixels = 0, first = 0;
  };

  bool count_pixels(std::span<const std::uint32_t> ids);
  void list_found(std::vector<seen_polygon>& seen);
  void add_importance(const float* depths, std::size_t stride, const face_view& face, float at_far_plane,
                      std::array<double, 4>& importance);

  std::vector<count> counts_;                                          // by source id; all 0 between hemicubes
  std::vector<std::uint64_t> found_;                                   // a bit per source id with pixels
  std::vector<float> q_, inverse_, q_below_, inverse_below_, weight_;  // a row of pixels, and the one below it
};

}  // namespace sightcell::bake
