#pragma once
// Computes the polygon list and the importance sums of a drawn atlas. Two implementations give the same result.
//
// Importance of a pixel with d = eye-space depth along the face's axis / far plane, at most 1 (background 1):
//   I = 1/d * [ w_r (d(x_r) - d), w_u (d(x_u) - d), w_l (d(x_l) - d), w_d (d(x_d) - d) ], positive parts only,
// neighbors inside the face's own image, w_r = (x + 0.5) / W, w_u = (y + 0.5) / H with y up, w_l = 1 - w_r,
// w_d = 1 - w_u, in image axes of each face. Both implementations use q = near / (far * d), the value in the
// depth image.
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "hemicube/gpu/gpu_objects.h"
#include "hemicube/gpu/polygon_counts.h"
#include "hemicube/hemicube_faces.h"
#include "hemicube/hemicube_source.h"

namespace sightcell::bake {

struct hemicube_atlas {
  std::uint32_t resolution;
  float near_over_far;
  GLuint framebuffer, ids, depths;
};

// Reads ids and depths of the whole atlas, row by row. Both spans have 3 S x S elements.
void read_atlas(const hemicube_atlas& atlas, std::span<std::uint32_t> ids, std::span<float> depths);

class gpu_gather {
 public:
  virtual ~gpu_gather() = default;
  // Fills view with the occluders in the atlas and the non-occluders that the see-through pass counted. spent: if not
  // null, gather and statistics are filled in, as far as they can be measured separately.
  virtual void run(const hemicube_atlas& atlas, std::span<const face_view, face_count> faces, hemicube_view& view,
                   sample_split* spent = nullptr) = 0;
};

// Reads the pixels back and counts on the CPU. marked: counts of the see-through pass; null without non-occluders.
std::unique_ptr<gpu_gather> make_gather_read_back(std::uint32_t polygon_count, polygon_counts* marked);

}  // namespace sightcell::bake
