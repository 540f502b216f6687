#pragma once
// What an engine has on the device before it hears of visibility: vertex and index buffers, transforms, materials. Two
// ways to keep a scene, as a .pvs file has two layouts:
//   instanced: one vertex and one index buffer per primitive, which all its instances share; it issues draws.
//   merged: all that does not move in world space, one vertex and one index buffer; it issues draw groups.
// What is issued is called a unit here, so that all else is written once. Units have the numbers of the .pvs file.
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "gl_buffer.h"
#include "sightcell/picture/textures.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"

namespace engine_hook {

// Buffers and state that a draw call needs: of a primitive, or of a draw group.
struct batch {
  GLuint vertices = 0, indices = 0;
  GLuint uvs = 0;  // 0: its alpha is not tested
  GLuint texture = 0;
  float alpha = 1.0f, alpha_cutoff = 0.0f;
  bool double_sided = false, blended = false;
};

struct unit {
  std::uint32_t batch = 0;
  std::uint32_t first_index = 0, index_count = 0;  // in the batch's index buffer
  bool drawn = false;  // false: the engine draws it by itself, when it likes: what moves, coarser levels of detail
};

class engine_scene {
 public:
  // Instanced. db: baked from s. Both must outlive the object.
  engine_scene(const sightcell::scene::scene& s, const sightcell::db& db, const std::string& pvs_file);
  // Merged: packed is what `sightcell pack` wrote of the scene and this file.
  engine_scene(const sightcell::scene::scene& packed, const sightcell::db& db, const std::string& packed_file,
               const std::string& pvs_file);

  // After a new bake: polygons and draws may have other numbers now. Vertices and materials stay where they are. Only
  // for instanced ones: a merged mesh is packed anew with its file.
  void follow(const sightcell::db& db, const std::string& pvs_file);

  bool merged() const { return merged_; }
  const std::vector<batch>& batches() const { return batches_; }
  const std::vector<unit>& units() const { return units_; }
  // One instance_data per unit: the vertex shader finds it by the draw call's base instance.
  GLuint instances() const { return instances_.id(); }
  // Three indices per stored polygon, as they lie in the batches' index buffers: what sightcell_view_indices copies.
  std::span<const std::uint32_t> stored_indices() const { return stored_indices_; }

 private:
  void add_batch(const sightcell::scene::geometry& g, std::uint32_t material, GLuint vertices, GLuint indices);
  void fill_instances(const std::vector<const sightcell::scene::draw*>& draw_of_unit);

  const sightcell::scene::scene& scene_;
  bool merged_;
  sightcell::picture::texture_set textures_;
  std::deque<gl_buffer> buffers_;
  gl_buffer instances_;
  std::vector<batch> batches_;
  std::vector<std::uint32_t> batch_of_draw_;  // by number of the scene's draw
  std::vector<unit> units_;
  std::vector<std::uint32_t> stored_indices_;
};

// As the vertex shader reads it.
struct instance_data {
  float to_world[12];      // rows of three, each with its translation
  std::uint32_t mirrored;  // 1: the transform turns polygons over
  std::uint32_t unit;
};

}  // namespace engine_hook
