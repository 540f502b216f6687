#pragma once
// What an engine has before it uses visibility: vertices, indices, clusters and materials, as plain arrays. All
// primitives share one vertex buffer and one index buffer, and instances share those of their primitive.
#include <cstdint>
#include <vector>

#include "gpu_records.h"
#include "level_table.h"
#include "sightcell/scene/scene.h"

namespace gpu_driven {

enum class facing : std::uint8_t { front, mirrored, both };  // which side of a polygon is drawn

// Clusters with the same state of the pipeline. They follow each other.
struct bin {
  sightcell::scene::alpha_mode alpha = sightcell::scene::alpha_mode::opaque;
  facing faces = facing::front;
  std::uint32_t first_cluster = 0, cluster_count = 0;

  bool is_blended() const { return alpha == sightcell::scene::alpha_mode::blend; }
};

struct host_scene {
  std::vector<vertex> vertices;
  std::vector<std::uint32_t> indices;            // the host's order: triangles of a cluster follow each other
  std::vector<bin> bins;                         // opaque ones first, blended ones last
  std::vector<cluster_record> clusters;          // by bin; those of a draw: its clusters, then coarse ones
  std::vector<instance_record> instances;        // of each cluster
  std::vector<level_group_record> level_groups;  // of all draws
  std::vector<std::uint32_t> cluster_of_source;  // for sightcell_cluster_map_create: by source id
  std::vector<material_record> materials;
  std::vector<std::uint32_t> textures;  // images of the scene, by layer; no_index, which layer 0 has: white
  std::uint64_t triangles = 0;          // of all clusters but coarse ones
  std::uint32_t coarse_clusters = 0;
  std::uint32_t draws = 0;  // of the scene, those that are drawn
  float size = 1.0f;        // meters: diagonal of all that is drawn
};

// Arranges a scene for drawing. It needs nothing of the .pvs file: clusters refer to polygons by source id.
// levels: of the file of the scene; empty for none. Throws gpu-driven.levels if they are of another scene.
host_scene arrange(const sightcell::scene::scene& s, const level_table& levels);

}  // namespace gpu_driven
