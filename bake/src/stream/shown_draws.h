#pragma once
// The draws that ordinary viewers of 3D Tiles show (docs/streaming.md, "3D Tiles").
#include <array>
#include <cstdint>
#include <vector>

#include "sightcell/scene/stream_pages.h"

namespace sightcell::bake {

// The matrix of a draw as the front has it: the columns of its upper three rows.
using draw_matrix = std::array<float, 12>;

class shown_draws {
 public:
  // pager: prepared.
  explicit shown_draws(const scene::gltf_pager& pager);

  // Returns the draws of a geometry, ascending: without those marked `never`, coarser levels of detail, and draws so
  // far away that no float has their place. Draws that the host moves are where the file has them.
  const std::vector<std::uint32_t>& of(std::uint32_t geometry) const { return draws_of_[geometry]; }

  // Returns a number that only draws with equal matrices share.
  std::uint32_t place_of(std::uint32_t draw) const { return place_of_[draw]; }
  const draw_matrix& matrix_at(std::uint32_t place) const { return matrices_[place]; }

 private:
  std::vector<std::vector<std::uint32_t>> draws_of_;
  std::vector<std::uint32_t> place_of_;
  std::vector<draw_matrix> matrices_;
};

}  // namespace sightcell::bake
