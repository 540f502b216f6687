#include "cells/explicit_cells.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "cells/lattice.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr float coordinate_limit = 1e7f;  // meters; beyond it the spacing of floats is a meter or more

view_cell explicit_cell(const cell_box& box, std::size_t number, const std::string& subject,
                        const std::string& remedy) {
  std::string label = fmt::format("cell {}", number);
  if (!box.name.empty()) label += fmt::format(" \"{}\"", box.name);
  const auto refuse = [&](const char* id, const std::string& cause) {
    throw error(error_kind::bad_input, id, subject, label + cause, remedy);
  };
  for (const auto& [key, corner] : {std::pair("min", &box.min), std::pair("max", &box.max)}) {
    for (const float value : *corner) {
      if (!std::isfinite(value))
        refuse("cells.not-finite", fmt::format(": \"{}\" holds a number that is not finite", key));
      if (std::abs(value) > coordinate_limit)
        refuse("cells.too-far",
               fmt::format(": \"{}\" holds {:g}, more than {:g} m from the origin", key, value, coordinate_limit));
    }
  }
  view_cell cell;
  cell.name = box.name;
  cell.number = static_cast<std::uint32_t>(number);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(box.min[axis] < box.max[axis]))
      refuse("cells.empty-box",
             fmt::format(": min {} is not below max {} on {}", box.min[axis], box.max[axis], "xyz"[axis]));
    cell.min[static_cast<int>(axis)] = box.min[axis];
    cell.max[static_cast<int>(axis)] = box.max[axis];
  }
  cell.floor = static_cast<double>(cell.min.y);
  for (const auto& corner : {box.min, box.max}) {
    for (const float value : corner)
      // + 0 turns -0 into 0, so that both hash alike.
      cell.place = mix(cell.place, std::bit_cast<std::uint32_t>(value + 0.0f));
  }
  return cell;
}

}  // namespace

std::vector<view_cell> explicit_cells(std::span<const cell_box> boxes, const std::string& subject,
                                      const std::string& remedy) {
  if (boxes.size() > explicit_cell_limit)
    throw error(error_kind::bad_input, "cells.too-many", subject,
                fmt::format("holds {} cells, more than {}", boxes.size(), explicit_cell_limit),
                "split the scene into several bakes");
  std::vector<view_cell> cells;
  cells.reserve(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) cells.push_back(explicit_cell(boxes[i], i, subject, remedy));
  return cells;
}

}  // namespace sightcell::bake
