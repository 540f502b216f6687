#include "cells/floors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <limits>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace sightcell::bake {
namespace {

// Meters: less than storeys are apart, which need head room and a ceiling.
constexpr double same_storey = 2.4;
constexpr double least_step = 2.0;          // meters: neighbors with a larger difference of height are not joined
constexpr double most_squares = 1024.0;     // along the longer side of the plan
constexpr double tolerated_overlap = 0.05;  // of the smaller part: cliffs inside a cell look like two storeys
constexpr double joined_overlap = 0.1;      // of a small part that is joined to a floor
constexpr std::size_t fewest_squares = 8;   // of a floor
constexpr double least_share = 0.01;        // of all squares, of a floor

struct plan_square {
  std::int32_t z = 0, x = 0;
  auto operator<=>(const plan_square&) const = default;
};

struct hash_of_plan_square {
  std::size_t operator()(const plan_square& s) const {
    return static_cast<std::size_t>(s.z) * 0x9E3779B97F4A7C15u ^ static_cast<std::size_t>(s.x) * 0xC2B2AE3D27D4EB4Fu;
  }
};

struct heights {
  double lowest = std::numeric_limits<double>::infinity(), highest = -std::numeric_limits<double>::infinity();
  double reach = 0.0;  // what is this far above or below is of the same storey
  void add(const heights& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
    reach = std::max(reach, other.reach);
  }
};

// Cells that are joined, and the squares of the plan that they cover.
struct part {
  std::vector<std::uint32_t> cells;
  std::unordered_map<plan_square, heights, hash_of_plan_square> squares;

  void add(part&& other) {
    cells.insert(cells.end(), other.cells.begin(), other.cells.end());
    for (const auto& [at, height] : other.squares) squares[at].add(height);
    other = {};
  }
};

// Layers of a grid are storeys of their own; automatic cells are over floors.
double reach_of(const view_cell& cell) {
  return cell.floor_area > 0.0 ? same_storey : 0.5 * static_cast<double>(cell.max.y - cell.min.y);
}

// Returns the number of squares in which the two parts are different storeys.
std::size_t overlap(const part& a, const part& b) {
  const part &few = a.squares.size() < b.squares.size() ? a : b, &many = &few == &a ? b : a;
  std::size_t count = 0;
  for (const auto& [at, height] : few.squares) {
    const auto found = many.squares.find(at);
    if (found == many.squares.end()) continue;
    const heights& other = found->second;
    const double gap = std::max(height.lowest, other.lowest) - std::min(height.highest, other.highest);
    if (gap > std::max(height.reach, other.reach)) ++count;
  }
  return count;
}

// The plan in squares as wide as the narrowest cell.
class plan_grid {
 public:
  explicit plan_grid(std::span<const view_cell> cells) {
    glm::vec3 max = cells.front().max;
    min_ = cells.front().min;
    width_ = std::numeric_limits<double>::infinity();
    for (const view_cell& cell : cells) {
      min_ = glm::min(min_, cell.min);
      max = glm::max(max, cell.max);
      width_ = std::min(width_, static_cast<double>(std::min(cell.max.x - cell.min.x, cell.max.z - cell.min.z)));
    }
    width_ = std::max(width_, static_cast<double>(std::max(max.x - min_.x, max.z - min_.z)) / most_squares);
  }

  double width() const { return width_; }

  // Returns the squares whose centers are in the cell; that of its center if there are none.
  std::pair<plan_square, plan_square> squares_of(const view_cell& cell) const {
    const auto [x0, x1] = along(cell.min.x - min_.x, cell.max.x - min_.x);
    const auto [z0, z1] = along(cell.min.z - min_.z, cell.max.z - min_.z);
    return {{z0, x0}, {z1, x1}};
  }

 private:
  std::pair<std::int32_t, std::int32_t> along(float low, float high) const {
    const double from = static_cast<double>(low) / width_, to = static_cast<double>(high) / width_;
    const auto first = static_cast<std::int32_t>(std::ceil(from - 0.5));
    const auto last = static_cast<std::int32_t>(std::ceil(to - 0.5)) - 1;
    const auto middle = static_cast<std::int32_t>(std::floor(0.5 * (from + to)));
    return first <= last ? std::pair(first, last) : std::pair(middle, middle);
  }

  glm::vec3 min_{0.0f};
  double width_ = 1.0;
};

struct joint {
  double difference = 0.0;  // of height, meters
  std::uint32_t a = 0, b = 0;
  auto operator<=>(const joint&) const = default;
};

using columns = std::unordered_map<plan_square, std::vector<std::uint32_t>, hash_of_plan_square>;

// Adds the joints between a cell and those cells of a column that come after it in the list.
void add_joints(std::span<const view_cell> cells, std::uint32_t cell, const columns& in_column, const plan_square& at,
                double most, std::vector<joint>& joints) {
  const auto found = in_column.find(at);
  if (found == in_column.end()) return;
  const double floor = cells[cell].floor;
  const auto lower = [&](std::uint32_t other, double height) { return cells[other].floor < height; };
  for (auto i = std::lower_bound(found->second.begin(), found->second.end(), floor - most, lower);
       i != found->second.end() && cells[*i].floor <= floor + most; ++i)
    if (*i > cell) joints.push_back({std::abs(cells[*i].floor - floor), cell, *i});
}

std::vector<joint> joints_of(std::span<const view_cell> cells, const plan_grid& grid) {
  columns in_column;
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    const auto [first, last] = grid.squares_of(cells[cell]);
    for (std::int32_t z = first.z; z <= last.z; ++z)
      for (std::int32_t x = first.x; x <= last.x; ++x) in_column[{z, x}].push_back(cell);
  }
  for (auto& [at, column] : in_column)
    std::sort(column.begin(), column.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(cells[a].floor, a) < std::pair(cells[b].floor, b);
    });
  const double step = std::max(grid.width(), least_step);
  std::vector<joint> joints;
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    const auto [first, last] = grid.squares_of(cells[cell]);
    for (std::int32_t z = first.z - 1; z <= last.z + 1; ++z)
      for (std::int32_t x = first.x - 1; x <= last.x + 1; ++x) {
        const bool beside_z = z < first.z || z > last.z, beside_x = x < first.x || x > last.x;
        if (beside_z && beside_x) continue;
        add_joints(cells, cell, in_column, {z, x}, beside_z || beside_x ? step : reach_of(cells[cell]), joints);
      }
  }
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  return joints;
}

// Joins cells to parts, which are sorted from the largest.
std::vector<part> join_cells(std::span<const view_cell> cells) {
  const plan_grid grid(cells);
  std::vector<part> parts(cells.size());
  std::vector<std::uint32_t> part_of(cells.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    part_of[cell] = cell;
    parts[cell].cells.push_back(cell);
    const auto [first, last] = grid.squares_of(cells[cell]);
    for (std::int32_t z = first.z; z <= last.z; ++z)
      for (std::int32_t x = first.x; x <= last.x; ++x)
        parts[cell].squares[{z, x}] = {cells[cell].floor, cells[cell].floor, reach_of(cells[cell])};
  }
  for (const joint& one : joints_of(cells, grid)) {
    std::uint32_t into = part_of[one.a], from = part_of[one.b];
    if (into == from) continue;
    if (parts[into].squares.size() < parts[from].squares.size()) std::swap(into, from);
    if (static_cast<double>(overlap(parts[into], parts[from])) >
        tolerated_overlap * static_cast<double>(parts[from].squares.size()))
      continue;
    for (const std::uint32_t cell : parts[from].cells) part_of[cell] = into;
    parts[into].add(std::move(parts[from]));
  }
  std::erase_if(parts, [](const part& p) { return p.cells.empty(); });
  std::stable_sort(parts.begin(), parts.end(),
                   [](const part& a, const part& b) { return a.squares.size() > b.squares.size(); });
  return parts;
}

// Returns the mean difference of height between a part and what a floor has in the squares around it; infinity if it
// has nothing there.
double difference_around(const part& small, const part& floor) {
  constexpr std::int32_t around = 2;  // squares
  double sum = 0.0;
  std::size_t count = 0;
  std::vector<std::pair<plan_square, heights>> squares(small.squares.begin(), small.squares.end());
  std::sort(squares.begin(), squares.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [at, height] : squares)
    for (std::int32_t z = at.z - around; z <= at.z + around; ++z)
      for (std::int32_t x = at.x - around; x <= at.x + around; ++x) {
        const auto found = floor.squares.find({z, x});
        if (found == floor.squares.end()) continue;
        sum += std::abs(found->second.lowest - height.lowest);
        ++count;
      }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::infinity();
}

double mean_height(const part& p, std::span<const view_cell> cells) {
  double sum = 0.0;
  for (const std::uint32_t cell : p.cells) sum += cells[cell].floor;
  return sum / static_cast<double>(p.cells.size());
}

// Returns the floor to which a small part is joined, and whether it covers other cells there.
std::pair<std::size_t, bool> best_floor(const part& small, std::span<const part> floors,
                                        std::span<const view_cell> cells) {
  std::tuple<bool, double, double, std::size_t> best{true, std::numeric_limits<double>::infinity(), 0.0, floors.size()};
  for (std::size_t i = 0; i < floors.size(); ++i) {
    const bool covers =
        static_cast<double>(overlap(small, floors[i])) > joined_overlap * static_cast<double>(small.squares.size());
    const double apart = std::abs(mean_height(small, cells) - mean_height(floors[i], cells));
    const std::tuple<bool, double, double, std::size_t> here{covers, difference_around(small, floors[i]), apart, i};
    if (std::get<3>(best) == floors.size() || here < best) best = here;
  }
  return {std::get<3>(best), std::get<0>(best)};
}

// Joins floors that cover nothing of each other, those of nearest heights first: two buildings are one picture.
void put_beside(std::vector<part>& floors, std::span<const view_cell> cells) {
  std::vector<double> height;
  for (const part& p : floors) height.push_back(mean_height(p, cells));
  // Below the diagonal: whether two floors overlap.
  std::vector<std::vector<bool>> apart(floors.size());
  const auto are_apart = [&](std::size_t a, std::size_t b) {
    const std::size_t size = std::min(floors[a].squares.size(), floors[b].squares.size());
    return static_cast<double>(overlap(floors[a], floors[b])) <= tolerated_overlap * static_cast<double>(size);
  };
  for (std::size_t a = 0; a < floors.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) apart[a].push_back(are_apart(a, b));
  while (true) {
    std::tuple<double, std::size_t, std::size_t> best{std::numeric_limits<double>::infinity(), 0, 0};
    for (std::size_t a = 0; a < floors.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (apart[a][b]) best = std::min(best, {std::abs(height[a] - height[b]), a, b});
    const auto [difference, from, into] = best;
    if (from == into) break;
    floors[into].add(std::move(floors[from]));
    height[into] = mean_height(floors[into], cells);
    for (std::size_t other = 0; other < floors.size(); ++other) {
      const bool there = other != into && other != from && !floors[other].cells.empty() && are_apart(other, into);
      if (other != into) apart[std::max(other, into)][std::min(other, into)] = there;
      if (other != from) apart[std::max(other, from)][std::min(other, from)] = false;
    }
  }
  std::erase_if(floors, [](const part& p) { return p.cells.empty(); });
}

// Returns the floors from the lowest up.
std::vector<cell_floor> in_order(std::vector<part> floors, std::span<const view_cell> cells) {
  std::stable_sort(floors.begin(), floors.end(),
                   [&](const part& a, const part& b) { return mean_height(a, cells) < mean_height(b, cells); });
  std::vector<cell_floor> found;
  for (part& p : floors) {
    std::sort(p.cells.begin(), p.cells.end());
    cell_floor floor{.cells = std::move(p.cells)};
    const auto [low, high] = std::minmax_element(floor.cells.begin(), floor.cells.end(),
                                                 [&](auto a, auto b) { return cells[a].floor < cells[b].floor; });
    floor.lowest = cells[*low].floor;
    floor.highest = cells[*high].floor;
    found.push_back(std::move(floor));
  }
  return found;
}

}  // namespace

std::vector<cell_floor> find_floors(std::span<const view_cell> cells, std::size_t most) {
  if (cells.empty()) return {};
  std::vector<part> floors, small;
  std::vector<part> parts = join_cells(cells);
  std::size_t squares = 0;
  for (const part& p : parts) squares += p.squares.size();
  for (part& p : parts) {
    const std::size_t size = p.squares.size();
    const bool large =
        size >= fewest_squares && static_cast<double>(size) >= least_share * static_cast<double>(squares);
    (floors.empty() || large ? floors : small).push_back(std::move(p));
  }
  put_beside(floors, cells);
  std::stable_sort(floors.begin(), floors.end(),
                   [](const part& a, const part& b) { return a.squares.size() > b.squares.size(); });
  while (floors.size() > most) {
    small.push_back(std::move(floors.back()));
    floors.pop_back();
  }
  for (part& p : small) {
    const auto [floor, covers] = best_floor(p, floors, cells);
    if (covers && p.squares.size() >= fewest_squares && floors.size() < most)
      floors.push_back(std::move(p));
    else
      floors[floor].add(std::move(p));
  }
  return in_order(std::move(floors), cells);
}

}  // namespace sightcell::bake
