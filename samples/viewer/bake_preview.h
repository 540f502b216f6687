#pragma once
// The map of a bake that is still running: its finished cells light up.
#include <chrono>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "background_bake.h"
#include "cell_map.h"

namespace viewer {

class bake_preview {
 public:
  // world must outlive the object.
  explicit bake_preview(const sightcell::scene::world_geometry& world) : world_(world) {}

  // Takes the cells that are finished. A map is made anew when there are a quarter more of them, once per second at
  // most, and shown when its plan is drawn.
  // complete: no more cells come.
  void update(std::span<const finished_cell> finished, const glm::vec3& eye, bool complete);
  // Null before the first cells.
  cell_map* map() const { return shown_.get(); }

 private:
  using clock = std::chrono::steady_clock;

  const sightcell::scene::world_geometry& world_;
  std::unique_ptr<cell_map> shown_, coming_;
  clock::time_point made_{};
};

}  // namespace viewer
