#pragma once
// All vertices of a scene for a packed file, attribute by attribute.
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "gltf_attributes.h"
#include "import_scene.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// An attribute in the buffer.
struct vertex_column {
  std::string name;
  std::uint32_t width = 0;   // floats per vertex
  std::uint64_t offset = 0;  // of the first vertex, in bytes
};

class packed_vertices {
 public:
  // moves: by draw. References must outlive the object.
  packed_vertices(const scene& s, const pose_list& poses, const std::vector<bool>& moves, gltf_attributes& attributes);

  std::uint32_t count() const { return count_; }
  // Returns the bytes of all vertices.
  std::uint64_t bytes() const { return bytes_; }
  const std::vector<vertex_column>& columns() const { return columns_; }  // POSITION first
  // Returns the attributes that the primitive of a draw has in the file.
  const attribute_widths& attributes_of(std::uint32_t draw) const;

  // Computes the results of the next three functions from all positions.
  void find_bounds();
  glm::vec3 min() const { return min_; }
  glm::vec3 max() const { return max_; }
  // Returns the vertices that are not finite and are placed at the origin; ascending.
  const std::vector<std::uint32_t>& broken() const { return broken_; }

  // into: has bytes() bytes.
  void write(std::span<std::byte> into);

 private:
  void list_columns();
  glm::vec3 place(const draw& d, std::size_t number, const glm::vec3& local) const;
  attribute_values at_rest(const draw& d);
  void write_draw(const draw& d, std::size_t number, const attribute_values& values, std::span<std::byte> into) const;

  const scene& scene_;
  const pose_list& poses_;
  const std::vector<bool>& moves_;
  gltf_attributes& attributes_;
  std::vector<const attribute_widths*> widths_of_draw_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, attribute_widths> widths_;  // by mesh and primitive
  std::vector<vertex_column> columns_;
  std::uint32_t count_ = 0;
  std::uint64_t bytes_ = 0;
  glm::vec3 min_{0.0f}, max_{0.0f};
  std::vector<std::uint32_t> broken_;
};

}  // namespace sightcell::scene
