#pragma once
// The flattened scene on the device, divided into clusters (gpu_culling.h selects the ones to draw).
//
// Polygons are stored in device order: by class (how they are drawn), inside a class by a recursive split in space, so
// that a cluster has a tight box. Absent polygons are left out. Corners at the same place share a vertex, except the
// last (provoking) corner of each polygon: its vertex carries the source id as a flat attribute. With gl_PrimitiveID in
// the fragment shader, llvmpipe processes indexed triangles one by one, and a hemicube costs 1.5 times as much. The
// vertices of masked polygons come first and are not shared.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hemicube/gpu/gpu_objects.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

enum polygon_class : std::uint32_t {
  opaque_single_sided = 0,
  opaque_double_sided,
  masked_single_sided,  // present where their alpha test passes
  masked_double_sided,
  see_through_single_sided,  // non-occluders: BLEND, or marked so
  see_through_double_sided,
  see_through_masked_single_sided,
  see_through_masked_double_sided,
  polygon_class_count
};

bool is_masked(polygon_class which);

class gpu_geometry {
 public:
  explicit gpu_geometry(const scene::world_geometry& world);
  ~gpu_geometry();
  gpu_geometry(const gpu_geometry&) = delete;
  gpu_geometry& operator=(const gpu_geometry&) = delete;

  bool has(polygon_class single_sided, polygon_class double_sided) const;
  bool has_see_through() const;  // any of the four classes
  std::uint32_t see_through_polygons() const;
  std::uint32_t polygon_count() const { return polygon_count_; }  // of the scene, absent ones included

  // Clusters are grouped by class. Polygons are in device order, the order of the clusters.
  struct cluster {
    glm::vec3 center, extent;  // half size
    std::uint32_t first_polygon, polygon_count;
  };
  struct index_range {
    std::uint32_t first = 0, count = 0;
  };
  std::span<const cluster> clusters() const { return clusters_; }
  index_range clusters_of(polygon_class which) const { return clusters_of_class_[which]; }
  // The cluster of each source id; 0 for polygons that are not drawn.
  std::vector<std::uint32_t> cluster_of_polygons() const;

  // Sets the state that all draws share. To be called once before a sequence of draws.
  void bind() const;
  // Binds vertices and indices (three 32-bit ones per polygon, in device order) of one class.
  void bind_vertices(polygon_class which) const;

  // For shaders and draws that select polygons.
  GLuint vertices() const { return vertices_->id(); }  // hemicube_buffer_vertices
  GLuint indices() const { return indices_->id(); }
  std::size_t vertex_bytes() const { return vertex_bytes_; }
  std::size_t index_bytes() const { return 3 * sizeof(std::uint32_t) * source_ids_.size(); }
  std::uint32_t drawn_polygons() const { return static_cast<std::uint32_t>(source_ids_.size()); }
  // Returns a vertex array of a class with other indices, which the caller deletes.
  GLuint make_vertex_array(polygon_class which, GLuint indices) const;

 private:
  void upload(const scene::world_geometry& world);
  void upload_masks(const scene::world_geometry& world);
  void add_mask_attributes(GLuint vertex_array) const;

  std::uint32_t polygon_count_ = 0;
  std::vector<cluster> clusters_;  // grouped by class
  std::array<index_range, polygon_class_count> clusters_of_class_;
  std::vector<std::uint32_t> source_ids_;  // in device order
  std::size_t vertex_bytes_ = 0;
  std::optional<gl_buffer> vertices_, indices_;
  std::optional<gl_buffer> mask_vertices_, masks_, texels_;  // only where the scene has masked polygons
  GLuint vertex_array_ = 0, masked_array_ = 0;
};

}  // namespace sightcell::bake
