#pragma once
// Finds the cells that a line crosses, for many cells anywhere: a grid of voxels about the size of a cell.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>
#include "sightcell/base/box.h"

namespace sightcell::bake {

// A cell on a line, and the part of the line inside it.
struct crossing {
  std::uint32_t cell = 0;
  float from = 0.0f, to = 0.0f;  // along the line, from < to
};

// The cells of a bake in a grid.
class segment_cells {
 public:
  explicit segment_cells(std::vector<box> cells);

  // Finds the cells that eye + t * direction crosses for t between from and to, which may be infinite; ascending,
  // each once. out is overwritten.
  void find(const glm::vec3& eye, const glm::vec3& direction, float from, float to, std::vector<crossing>& out) const;

  const std::vector<box>& boxes() const { return cells_; }

 private:
  using voxel = std::array<int, 3>;
  voxel voxel_of(const glm::vec3& point) const;
  std::size_t number_of(const voxel& v) const {
    return (static_cast<std::size_t>(v[2]) * static_cast<std::size_t>(count_[1]) + static_cast<std::size_t>(v[1])) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(v[0]);
  }
  template <typename Visit>
  void for_each_voxel(const box& of, Visit visit) const;

  std::vector<box> cells_;
  box all_;
  glm::vec3 size_{1.0f};  // of a voxel
  voxel count_{1, 1, 1};
  std::vector<std::uint32_t> begins_;  // per voxel: its first entry in members_; then the end of the last voxel
  std::vector<std::uint32_t> members_;
};

}  // namespace sightcell::bake
