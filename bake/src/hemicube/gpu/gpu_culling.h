#pragma once
// Which clusters are drawn for a hemicube, in three ways that show the same image: all; those in a face's frustum,
// found on the CPU; or, found on the device in two passes, those that are not hidden either.
//
// Of polygons at the same depth the last one drawn is kept, and clusters are drawn in the order of their numbers, so
// the image depends on nothing but the pose: leaving out what is hidden changes no pixel.
#include <memory>
#include <span>

#include "hemicube/gpu/gpu_geometry.h"
#include "hemicube/gpu/gpu_objects.h"
#include "hemicube/hemicube_faces.h"

namespace sightcell::bake {

// automatic: frustum on a software rasteriser, else occlusion, which is frustum where the device cannot do it.
enum class culling { automatic, none, frustum, occlusion };

class gpu_culling {
 public:
  virtual ~gpu_culling() = default;
  // Finds what the first pass draws.
  virtual void start(const glm::vec3& eye, std::span<const face_view, face_count> faces) = 0;
  // When everything that hides has been drawn: finds what the second pass draws, and binds the framebuffer that it
  // draws into. False: there is no second pass.
  virtual bool start_second() = 0;
  // When the second pass has been drawn: its pixels join those of the first, whose framebuffer is bound again.
  virtual void finish_second() = 0;
  // Draws the clusters of one class that were found for one face.
  virtual void draw(std::uint32_t face, polygon_class which) const = 0;
};

// frustum: only clusters that each face can see; else all.
std::unique_ptr<gpu_culling> make_frustum_culling(const gpu_geometry& geometry, bool frustum);

// What is drawn into, 3 S x S each, and what is attached to it.
struct culling_target {
  std::uint32_t resolution;
  GLuint framebuffer, ids, depths;
};

// The first pass draws what the last hemicubes saw; the hierarchical depth of that hides much of the rest.
std::unique_ptr<gpu_culling> make_occlusion_culling(const gpu_geometry& geometry, const culling_target& target);

// Can the device be told by itself how much to draw? (GL_ARB_indirect_parameters: OpenGL 4.6 has it, 4.5 need not.)
bool can_cull_on_device();

}  // namespace sightcell::bake
