#pragma once
// Where clutter could stand or hang: on houses, on towers and in the streets and yards of a block.
#include <vector>

#include "building.h"
#include "cells.h"
#include "clutter.h"
#include "plan.h"
#include "props.h"
#include "relief.h"
#include "tower.h"

namespace sightcell::city {

// What is tried first: without the first a town looks unfinished; the last are single leaves, which fill up any number.
enum class urgency : std::uint8_t { needed, wanted, filler, count };

struct clutter_wish {
  clutter_place place;
  urgency when = urgency::wanted;
};

// Finds places that leave the view cells free.
class dresser {
 public:
  dresser(const style& s, const relief& r, const std::vector<named_cell>& cells, random_stream& random)
      : style_(s), relief_(r), cells_(cells), random_(random) {}

  void dress_house(const building& house, std::vector<clutter_wish>& out);
  void dress_tower(const tower& t, std::vector<clutter_wish>& out);
  void dress_street(const plan& p, const block& b, std::vector<clutter_wish>& out);
  void furnish(const block& b, std::vector<prop_place>& out);  // props

 private:
  bool is_free(const glm::dvec3& at, double reach, bool on_ground) const;
  void wish(std::vector<clutter_wish>& out, clutter kind, const glm::dvec3& at, const glm::dvec2& along, double size,
            double chance, double lift = 0, urgency when = urgency::wanted);
  void dress_facade(const building& house, const facade& f, std::vector<clutter_wish>& out);
  void dress_window(const building& house, const facade& f, std::uint32_t row, std::uint32_t column,
                    std::vector<clutter_wish>& out);
  void dress_roof(const building& house, std::vector<clutter_wish>& out);
  void dress_bays(const tower& t, const ring& r, std::size_t edge, double low, std::uint32_t rows, bool is_podium,
                  std::vector<clutter_wish>& out);
  void dress_sunken_edge(const std::array<glm::dvec2, 2>& edge, bool has_stairs, std::vector<clutter_wish>& out);
  void hang_wires(const plan& p, const block& b, std::vector<clutter_wish>& out);
  void scatter(const ring& where, int count, double height, std::vector<clutter_wish>& out);
  void stand(std::vector<prop_place>& out, prop kind, const glm::dvec2& at, const glm::dvec2& facing, double lift);
  glm::dvec2 place_in(const ring& where, double rim);

  const style& style_;
  const relief& relief_;
  const std::vector<named_cell>& cells_;
  random_stream& random_;
};

}  // namespace sightcell::city
