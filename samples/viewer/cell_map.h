#pragma once
// The map over the picture: one plan per floor, with cells in the color of how many polygons they draw, of their bound,
// or of the time that the bake took for them.
#include <cstdint>
#include <future>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "background_bake.h"
#include "baked_scene.h"
#include "cell_floors.h"
#include "controls.h"
#include "sightcell/picture/floor_plan.h"

namespace viewer {

// A number per cell, in the part that is known, and its place on a ramp of colors.
class known_values {
 public:
  // All values that are above 0 and below `below` are known.
  known_values(std::vector<float> of_cell, float below);
  known_values() = default;

  bool any() const { return count_ > 0; }
  std::size_t count() const { return count_; }
  float lowest() const { return lowest_; }
  float highest() const { return highest_; }
  std::optional<float> of(std::uint32_t cell) const;
  // From the lowest to the highest value by logarithms, 0 .. 1.
  std::optional<float> heat(std::uint32_t cell) const;

 private:
  std::vector<float> of_cell_;
  std::size_t count_ = 0;
  float below_ = 0.0f, lowest_ = 0.0f, highest_ = 0.0f;
};

class cell_map {
 public:
  // Of a file. References must outlive the object: a plan may be drawn in a thread of its own.
  cell_map(const baked_scene& baked, const sightcell::scene::world_geometry& world);
  // Of the cells that a bake has finished. They are copied.
  cell_map(std::span<const finished_cell> finished, const sightcell::scene::world_geometry& world);
  ~cell_map();
  cell_map(const cell_map&) = delete;
  cell_map& operator=(const cell_map&) = delete;

  std::size_t size() const { return cells_.size(); }
  std::size_t timed() const { return seconds_.count(); }  // cells whose bake's time is known
  // Takes the times of a bake that this program has run: a file has none. Cells are found by their boxes.
  void take_seconds(std::span<const finished_cell> finished);
  // Colors cells by what an earlier map colored them by, if it is known here.
  void color_as(const cell_map& before) { coloring_ = before.coloring_; }
  // Begins to draw the plan of the floor around an eye. Returns whether it is there.
  bool prepare(const glm::vec3& eye);

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
  // Meters of the plan to pixels of the window.
  struct placement;
  void make_floors();
  void choose_floor(const glm::vec3& eye);
  void count_polygons(bool all);
  void begin_plan(std::size_t floor);
  void take_plan(plan& p, bool wait);
  void draw_title();
  void draw_legend(const glm::vec2& corner, float length);
  enum class coloring : std::uint8_t { polygons, bound, seconds };
  void draw_choice();
  std::optional<float> heat_of(std::uint32_t cell) const;
  const known_values& values() const { return coloring_ == coloring::bound ? bounds_ : seconds_; }
  std::optional<std::uint32_t> draw_cells(const fly_camera& camera, std::uint32_t here, std::uint32_t frozen);
  std::optional<std::uint32_t> draw_boxes(const placement& place, bool hovered) const;
  void write_tooltip(std::uint32_t cell) const;

  std::vector<cell> cells_;
  const sightcell::scene::world_geometry& world_;
  std::vector<map_floor> floors_;
  std::vector<std::size_t> floor_of_cell_;
  std::vector<plan> plans_;
  sightcell::picture::plan_rectangle frame_, extent_;
  std::optional<sightcell::view> view_;  // counts polygons
  std::vector<std::uint32_t> polygons_;  // by cell, as far as counted
  known_values bounds_, seconds_;
  coloring coloring_ = coloring::polygons;
  std::uint32_t most_ = 0;
  std::optional<std::size_t> floor_;
  std::uint32_t last_here_ = SIGHTCELL_NO_CELL;
};

}  // namespace viewer
