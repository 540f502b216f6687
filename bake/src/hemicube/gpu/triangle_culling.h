#pragma once
// The draws of the clusters that a pass of occlusion culling has selected, without the triangles that have no pixel for
// certain: those that face away, are outside of the image, cover no pixel's center, or, in the second pass, are
// occluded. A graphics device tests triangles in compute shaders faster than its rasterizer drops them.
#include <cstdint>

#include "hemicube/gpu/gpu_geometry.h"
#include "hemicube/gpu/gpu_objects.h"
#include "shared/hemicube_layout.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bake {

class triangle_culling {
 public:
  // geometry must outlive the object.
  // most_triangles: room for triangles of a pass; lists beyond it are drawn as whole clusters. Where it is 0, or the
  // device's storage buffers cannot hold the vertices, no triangle is tested.
  triangle_culling(const gpu_geometry& geometry, std::uint32_t most_triangles);
  ~triangle_culling();
  triangle_culling(const triangle_culling&) = delete;
  triangle_culling& operator=(const triangle_culling&) = delete;

  // hemicube_buffer_lists: compact.comp writes the numbers of clusters there.
  GLuint lists() const { return lists_.id(); }
  // Tests the triangles. The uniform blocks of culling must be bound, and compact.comp dispatched.
  // packed_commands: what compact.comp wrote.
  // second: also against the hierarchical depth, whose texture must be bound.
  void run(GLuint packed_commands, bool second) const;
  // Draws a list. packed_commands: of its clusters; first_command: number of the first.
  void draw(std::uint32_t face, polygon_class which, GLuint packed_commands, std::size_t first_command,
            std::uint32_t most_clusters) const;

 private:
  const gpu_geometry& geometry_;
  std::uint32_t room_;  // in triangles; 0: triangles are not tested
  bool may_overflow_;
  gl_buffer lists_, kept_, triangle_sums_, kept_indices_;
  picture::gl_program number_, first_, second_, pack_, whole_;
  GLuint vertex_array_ = 0, masked_array_ = 0;
};

}  // namespace sightcell::bake
