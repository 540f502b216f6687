#pragma once
// What an engine has before it uses visibility: vertices, indices, draws, materials and clusters, as plain arrays. All
// primitives share one vertex buffer and one index buffer, and instances share those of their primitive.
#include <cstdint>
#include <string>
#include <vector>

#include "gpu_records.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"

namespace vulkan_host {

enum class facing : std::uint8_t { front, mirrored, both };  // which side of a polygon is drawn

// Draws with the same pipeline. Their clusters follow each other.
struct bin {
  sightcell::scene::alpha_mode alpha = sightcell::scene::alpha_mode::opaque;
  facing faces = facing::front;
  std::uint32_t first_cluster = 0, cluster_count = 0;
  std::uint32_t first_draw = 0, draw_count = 0;  // in host_scene::sorted_draws

  bool is_blended() const { return alpha == sightcell::scene::alpha_mode::blend; }
};

// A draw without visibility: a piece of the index buffer in the host's own order.
struct whole_draw {
  std::uint32_t first_index = 0, index_count = 0;
};

struct host_scene {
  std::vector<vertex> vertices;
  std::vector<std::uint32_t> own_indices;        // the host's order: triangles of a cluster follow each other
  std::vector<std::uint32_t> stored_indices;     // the order of the .pvs file, for `commands`
  std::vector<draw_record> draws;                // in the order of the draw table of the .pvs file
  std::vector<whole_draw> whole_draws;           // of each draw
  std::vector<std::uint32_t> sorted_draws;       // those that are drawn, by bin
  std::vector<bin> bins;                         // opaque ones first, blended ones last
  std::vector<cluster_record> clusters;          // by bin
  std::vector<std::uint32_t> cluster_of_source;  // for sightcell_cluster_map_create: by source id
  std::vector<material_record> materials;
  std::vector<std::uint32_t> textures;  // images of the scene, by layer; no_index, which layer 0 has: white
  float size = 1.0f;                    // meters: diagonal of all that is drawn
};

// Arranges a scene for drawing.
// db: baked from s. pvs_file: its name, for messages.
// Throws vulkan.other-scene, vulkan.layout, vulkan.per-instance, vulkan.runtime.
host_scene arrange(const sightcell::scene::scene& s, const sightcell::db& db, const std::string& pvs_file);

}  // namespace vulkan_host
