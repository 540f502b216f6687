#include "style.h"

namespace sightcell::city {
namespace {

constexpr style old_town() {
  style s;
  s.polygons_per_block = 54000;
  s.relief_height = 11.0;
  s.relief_length = 120.0;
  s.plan.sunken_every = 4;
  s.plan.has_covered_passages = true;
  return s;
}

constexpr style vienna800k() {
  style s = old_town();
  s.name = "vienna800k";
  s.polygons = 865'979;
  return s;
}

constexpr style vienna8m() {
  style s = old_town();
  s.name = "vienna8m";
  s.polygons = 7'928'519;
  return s;
}

constexpr style hongkong() {
  style s;
  s.name = "hongkong";
  s.polygons = 2'164'567;
  s.polygons_per_block = 68000;
  s.has_towers = true;
  s.floors_low = 7;
  s.floors_more = 9;
  s.relief_height = 14.0;
  s.relief_length = 170.0;
  s.plan.street_widths = {14.0, 7.0, 18.0, 10.0};
  s.plan.boundary_width = 14.0;
  s.plan.block_low = 66.0;
  s.plan.block_high = 80.0;
  s.plan.building_depth = 15.0;
  s.plan.lot_width = 17.0;
  s.plan.sunken_every = 4;
  s.plan.sunken_width = 20.0;
  s.plan.has_covered_passages = true;
  return s;
}

constexpr std::array<style, 3> presets = {vienna800k(), vienna8m(), hongkong()};

}  // namespace

const style* find_preset(std::string_view name) {
  for (const style& s : presets) {
    if (s.name == name) return &s;
  }
  return nullptr;
}

std::string_view preset_names() {
  return "vienna800k, vienna8m or hongkong";
}

}  // namespace sightcell::city
