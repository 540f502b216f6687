#pragma once
// Selects the clusters that are drawn for a hemicube. There are three ways, with the same image: all clusters; those in
// the frustum of a face, selected on the CPU; those that are not occluded either, selected on the device in two passes.
//
// Of polygons at the same depth the last one drawn is kept, and clusters are drawn in the order of their numbers. So
// the image depends on the pose only, and leaving out occluded clusters changes no pixel.
#include <memory>
#include <span>

#include "hemicube/gpu/gpu_geometry.h"
#include "hemicube/gpu/gpu_objects.h"
#include "hemicube/hemicube_faces.h"

namespace sightcell::bake {

// automatic: frustum on a software rasterizer, otherwise occlusion. occlusion: frustum where the device lacks a
// feature.
enum class culling { automatic, none, frustum, occlusion };

class gpu_culling {
 public:
  virtual ~gpu_culling() = default;
  // Selects the clusters of the first pass.
  virtual void start(const glm::vec3& eye, std::span<const face_view, face_count> faces) = 0;
  // To be called when the first pass has drawn the occluders. Selects the clusters of the second pass and binds its
  // framebuffer. Returns false if there is no second pass.
  virtual bool start_second() = 0;
  // To be called when the second pass has been drawn. Merges its pixels into those of the first pass and binds the
  // framebuffer of the first pass again.
  virtual void finish_second() = 0;
  // Draws the clusters of one class that are selected for one face.
  virtual void draw(std::uint32_t face, polygon_class which) const = 0;
};

// frustum: selects the clusters in the frustum of each face; otherwise all.
std::unique_ptr<gpu_culling> make_frustum_culling(const gpu_geometry& geometry, bool frustum);

// The framebuffer that is drawn into, and its attachments, 3 S x S pixels each.
struct culling_target {
  std::uint32_t resolution;
  GLuint framebuffer, ids, depths;
};

// The first pass draws the clusters that were visible in the last hemicubes. Their hierarchical depth occludes most of
// the others.
// most_triangles: room on the device for the triangles of one pass, 12 bytes each. What has no room is drawn all the
// same, with triangles that have no pixels. 0: triangles are not tested.
std::unique_ptr<gpu_culling> make_occlusion_culling(const gpu_geometry& geometry, const culling_target& target,
                                                    std::uint32_t most_triangles);

// True if the device can read the number of draws from a buffer (GL_ARB_indirect_parameters, optional in OpenGL 4.5).
bool can_cull_on_device();

}  // namespace sightcell::bake
