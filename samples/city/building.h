#pragma once
// One house: a closed shell whose street and yard walls are grids of cells; a cell is plain wall or a recessed window
// with ever more detail. How much detail there is decides how many polygons the house has, to the unit.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh.h"
#include "plan.h"
#include "random.h"

namespace sightcell::city {

// Each level includes the ones before it.
enum class window_level : std::uint8_t { none, recess, pane, sill, bars, count };

struct facade {
  std::size_t edge = 0;             // of the footprint
  std::vector<window_level> cells;  // floor by floor from the ground, along the edge; only where a window fits
  std::vector<bool> balconies;
  std::uint32_t door = 0xFFFFFFFFu;  // column of the door on the ground floor
};

// How houses of a style differ from the plainest.
struct house_style {
  bool plain = false;  // one cell per wall and no floors, for the smallest cities
  std::uint32_t floors_low = 3, floors_more = 4;
  double base = building_base;  // where the walls begin; lower on slopes
};

// An opening in a street or yard wall, as seen from outside.
struct window_place {
  glm::dvec2 middle{0, 0}, along{1, 0}, out{0, 1};  // on the wall's plane; unit vectors
  double half = 0, low = 0, high = 0;
};

class building {
 public:
  building(std::string name, const lot& place, const house_style& style, random_stream& random);

  std::uint32_t columns(std::size_t edge) const { return columns_[edge]; }
  std::uint32_t floors() const { return floors_; }
  bool fits_window(std::size_t edge) const;
  bool is_pitched() const { return pitched_; }
  double eaves() const { return row_height(floors_); }
  const ring& footprint() const { return footprint_; }
  bool is_over_passage() const { return is_over_passage_; }
  double ridge_height() const { return pitched_ ? ridge_height_ : 0.0; }
  surface wall() const { return wall_; }
  surface roof() const { return roof_; }
  double row_height(std::uint32_t row) const;
  window_place place_of_window(const facade& f, std::uint32_t row, std::uint32_t column) const;
  glm::dvec2 inside(double along, double deep) const;  // 0..1 from the left party wall, 0..1 from the street
  std::uint64_t base_cost() const;                     // polygons with no detail at all

  // What may be changed between making the house and building its mesh.
  std::array<facade, 2> facades;  // street, yard
  std::uint32_t cornices = 0;     // bands on the street front, from the first floor up
  bool has_chimney = false;
  bool has_penthouse = false;  // set back from the front; flat roofs only

  static std::uint64_t window_cost(window_level level);  // polygons above those of the level before
  static constexpr std::uint64_t box_cost = 12;
  static constexpr std::uint64_t balcony_cost = 18;

  mesh build() const;
  double lift = 0;  // of its node: the ground it stands on

 private:
  glm::dvec2 column_point(std::size_t edge, std::uint32_t column) const;
  void build_wall(mesh& m, std::size_t edge) const;
  void build_cell(mesh& m, const facade& f, std::uint32_t row, std::uint32_t column) const;
  void build_window(mesh& m, window_level level, bool is_door, const std::array<glm::dvec3, 4>& cell,
                    const window_place& place, bool has_balcony) const;
  void build_bottom(mesh& m) const;
  void build_flat_roof(mesh& m) const;
  void build_pitched_roof(mesh& m) const;
  void build_extras(mesh& m) const;

  std::string name_;
  ring footprint_;
  std::array<std::uint32_t, 4> columns_{1, 1, 1, 1};
  std::uint32_t floors_ = 1;
  bool is_over_passage_ = false;
  double base_ = building_base;
  double ground_floor_ = 4.0;
  double floor_height_ = 3.2;
  bool pitched_ = false;
  double ridge_height_ = 0;
  surface wall_ = surface::plaster_cream;
  surface roof_ = surface::roof_tile;
};

}  // namespace sightcell::city
