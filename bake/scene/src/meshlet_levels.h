#pragma once
// The levels of detail of a packed file in meshlets: what follows the meshlets in version 2 of their table.
// docs/meshlets.md defines the bytes.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "meshlet_table.h"
#include "sightcell/scene/cluster_dag.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

class meshlet_levels {
 public:
  // Builds the levels of all primitives with meshlets.
  // packed: as for write_meshlet_table(); must outlive the object.
  // progress: called with the triangles that are done, and all. May be null.
  meshlet_levels(std::span<const meshlet_group> groups, const scene& packed,
                 const std::function<void(std::uint64_t done, std::uint64_t total)>& progress);

  std::uint64_t bytes() const;
  std::uint32_t coarse_meshlets() const { return coarse_; }
  // into: bytes() bytes.
  void write(std::span<std::byte> into) const;

 private:
  struct primitive_levels {
    const geometry* mesh = nullptr;
    bool sided = false;
    cluster_dag dag;
    std::uint32_t first_leaf = 0, first_coarse = 0, first_group = 0;  // in the table
  };
  std::uint32_t number_of(const primitive_levels& p, std::uint32_t cluster) const;

  std::vector<primitive_levels> all_;
  std::uint32_t leaves_ = 0, coarse_ = 0, groups_ = 0, indices_ = 0;
};

}  // namespace sightcell::scene
