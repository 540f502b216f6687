#pragma once
// Numbers for the polygons of all geometries: those that pages contain once, whatever number of draws has them.
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"
#include "sightcell/scene/stream_pages.h"

namespace sightcell::bake {

class polygon_numbers {
 public:
  // pager: prepared.
  explicit polygon_numbers(const scene::gltf_pager& pager);

  // Returns the number of polygons of all geometries.
  std::uint32_t count() const { return begin_.back(); }
  std::uint32_t begin_of(std::uint32_t geometry) const { return begin_[geometry]; }

  std::uint32_t draw_of(std::uint32_t source_id) const { return draw_of_[source_id]; }
  std::uint32_t number_of(std::uint32_t source_id) const { return source_id + offset_[draw_of_[source_id]]; }

 private:
  std::vector<std::uint32_t> begin_;    // by geometry, and the end
  std::vector<std::uint32_t> draw_of_;  // by source id
  std::vector<std::uint32_t> offset_;   // by draw: from source ids to numbers, modulo 2^32
};

}  // namespace sightcell::bake
