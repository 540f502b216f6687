#pragma once
// The map beside the picture: one plan per floor, with cells in the color of how many polygons they draw.
#include <cstdint>
#include <future>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "baked_scene.h"
#include "cell_floors.h"
#include "controls.h"
#include "sightcell/picture/floor_plan.h"

namespace viewer {

class cell_map {
 public:
  // References must outlive the object: a plan may be drawn in a thread of its own.
  cell_map(const baked_scene& baked, const sightcell::scene::world_geometry& world);
  ~cell_map();
  cell_map(const cell_map&) = delete;
  cell_map& operator=(const cell_map&) = delete;

  // Draws the window of the map with Dear ImGui. Returns the cell that was clicked.
  // here, frozen: the cell of the camera and the one whose set is drawn, or SIGHTCELL_NO_CELL.
  // wait: until the plan is there and all cells have their colors, for pictures.
  std::optional<std::uint32_t> draw(const fly_camera& camera, std::uint32_t here, std::uint32_t frozen,
                                    const glm::vec2& corner, const glm::vec2& size, bool wait);

 private:
  struct plan {
    bool begun = false;
    std::future<sightcell::picture::image_rgba> coming;
    unsigned texture = 0;
  };
  void count_polygons(bool all);
  void begin_plan(std::size_t floor);
  void take_plan(plan& p, bool wait);
  std::optional<std::uint32_t> draw_cells(const fly_camera& camera, std::uint32_t here, std::uint32_t frozen);

  const baked_scene& baked_;
  const sightcell::scene::world_geometry& world_;
  std::vector<map_floor> floors_;
  std::vector<std::size_t> floor_of_cell_;
  std::vector<plan> plans_;
  sightcell::picture::plan_rectangle frame_, extent_;
  std::optional<sightcell::view> view_;
  std::vector<std::uint32_t> polygons_;  // by cell, as far as counted
  std::uint32_t most_ = 0;
  std::size_t floor_ = 0;
  std::uint32_t last_here_ = SIGHTCELL_NO_CELL;
};

}  // namespace viewer
