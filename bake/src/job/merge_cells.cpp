#include "job/merge_cells.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cells/cell_blocks.h"
#include "cells/cell_sizes.h"
#include "cells/lattice.h"
#include "sightcell/base/random.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// By level: from how many cubes the polygons of a square are estimated. With as many for all levels, wide squares would
// seem to see too little, because what is visible from small parts of them is missed; with as many per area, too much,
// because a cell of level 0 has few cubes. Bakes of zdm2 (a game level) have 1.29, 1.81 and 2.74 times the polygons in
// squares of level 1, 2 and 3 that they have in the cells there, bakes of denhaag_01 (streets) 1.05, 1.17 and 1.35
// times. Estimates from 4 cubes on all levels are too low in both, those from 8, 16 and 32 too high; these numbers lie
// between.
constexpr std::array<std::size_t, cell_blocks::highest_level + 1> cubes_drawn{4, 6, 9, 13};
constexpr std::uint64_t most_tests = 256;        // of points, for an eye inside a cell
constexpr std::uint64_t most_corner_tests = 32;  // for an eye at a corner
constexpr std::size_t cubes_at_once = 128;       // between two reports
// Of how many blocks the cells of --cell-limit are: each has some dozen cells.
constexpr std::uint32_t cells_of_limited_block = 8;

// Ascending ids of the polygons that a full cube shows.
using cube = std::vector<std::uint32_t>;

// A cell of level 0 of a block, or a place without floor in a square that may become a cell.
struct looked_at {
  double floor_area = 0.0;
  bool valid = false;  // has a valid viewpoint
};

using block_places = std::map<lattice_position, looked_at>;

// Where cubes are rendered: inside a cell, or at the lower corner of a cell in x and z, so that up to four cells have
// the cube in common.
struct eye_place {
  lattice_position position;
  bool corner = false;
  auto operator<=>(const eye_place&) const = default;
};

using block_cubes = std::map<eye_place, std::optional<cube>>;

lattice_position square_around(lattice_position p, std::int32_t level) {
  while (p.level < level) p = lattice::wider(p);
  return p;
}

// Returns the squares of a block that may become cells, and adds their places without floor.
std::vector<lattice_position> squares_of(block_places& places) {
  std::vector<lattice_position> squares;
  std::map<lattice_position, std::uint32_t> floors;
  for (const auto& [position, place] : places)
    for (std::int32_t level = 1; level <= cell_blocks::highest_level; ++level) ++floors[square_around(position, level)];
  for (const auto& [square, count] : floors) {
    const std::int64_t side = std::int64_t{1} << square.level;
    if (count < 2 || 2 * std::int64_t{count} < side * side) continue;
    squares.push_back(square);
    for (std::int64_t z = square.z * side; z < (square.z + 1) * side; ++z)
      for (std::int64_t x = square.x * side; x < (square.x + 1) * side; ++x)
        places.try_emplace({.z = z, .y = square.y, .x = x});
  }
  return squares;
}

// Counts in how many cubes each polygon is.
class cube_counts {
 public:
  explicit cube_counts(std::size_t polygons) : count_(polygons, 0) {}

  // Returns the expected number of polygons in the union of `drawn` of the cubes, drawn at random without putting back;
  // of all cubes if there are fewer.
  double expected_union(std::span<const cube* const> cubes, std::size_t drawn) {
    for (const cube* one : cubes)
      for (const std::uint32_t polygon : *one)
        if (count_[polygon]++ == 0) touched_.push_back(polygon);
    const std::size_t all = cubes.size();
    std::vector<std::uint32_t> in_cubes(all + 1, 0);  // by the number of cubes: polygons that are in so many
    for (const std::uint32_t polygon : touched_) ++in_cubes[std::exchange(count_[polygon], 0)];
    touched_.clear();
    double expected = 0.0;
    for (std::size_t with = 1; with <= all; ++with) {
      double missed = 1.0;  // the probability that all drawn are among those without such a polygon
      for (std::size_t i = 0; i < std::min(drawn, all); ++i)
        missed *= all - with > i ? static_cast<double>(all - with - i) / static_cast<double>(all - i) : 0.0;
      expected += in_cubes[with] * (1.0 - missed);
    }
    return expected;
  }

 private:
  std::vector<std::uint16_t> count_;
  std::vector<std::uint32_t> touched_;
};

class block_estimates {
 public:
  block_estimates(const lattice& on, const settings& how, const merge_tools& tools)
      : on_(on), how_(how), tools_(tools), counts_([&] { return cube_counts(tools.own_polygons); }) {}

  // Adds the options of a block: its cells of level 0, and the squares that may become cells.
  // cells: those of the block.
  void add(std::span<const view_cell* const> cells, const std::function<void()>& pause,
           std::vector<cell_option>& options);

 private:
  std::optional<glm::vec3> find_eye(const eye_place& at) const;
  std::optional<cube> look(const eye_place& at) const;
  double drawn_from(const lattice_position& square, const block_places& places, const block_cubes& cubes);

  const lattice on_;
  const settings& how_;
  const merge_tools& tools_;
  tbb::enumerable_thread_specific<cube_counts> counts_;
};

// Returns a random valid viewpoint: anywhere in a cell; within the margin of a corner, which is in the grown boxes of
// all cells that meet there.
std::optional<glm::vec3> block_estimates::find_eye(const eye_place& at) const {
  const view_cell cell = on_.cell(at.position);
  random_stream random(how_.seed, cell.place, purpose::merging, at.corner ? 1 : 0);
  const glm::vec3 aside{how_.margin, 0.0f, how_.margin};
  const glm::vec3 corner{cell.min.x, cell.max.y, cell.min.z};
  const viewpoint_region where =
      at.corner ? viewpoint_region(cell.min - aside, corner + aside) : viewpoint_region(cell.min, cell.max);
  std::uint64_t tests = 0;
  const auto eyes = draw_viewpoints(tools_.rays, where, how_.player_radius, 1,
                                    at.corner ? most_corner_tests : most_tests, random, tests);
  return eyes.empty() ? std::nullopt : std::optional(eyes.front());
}

std::optional<cube> block_estimates::look(const eye_place& at) const {
  const std::optional<glm::vec3> eye = find_eye(at);
  if (!eye) return std::nullopt;
  std::array<pose, 2> poses;
  std::array<hemicube_view, 2> views;
  for (std::size_t i = 0; i < 2; ++i) {
    const float side = i == 0 ? 1.0f : -1.0f;
    poses[i] = {*eye, {0.0f, 0.0f, -side}, {side, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
  }
  tools_.source.render(poses, views);
  cube seen;
  for (const hemicube_view& view : views)
    for (const seen_polygon& polygon : view.seen)
      if (polygon.id < tools_.own_polygons) seen.push_back(polygon.id);
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

double block_estimates::drawn_from(const lattice_position& square, const block_places& places,
                                   const block_cubes& cubes) {
  const std::int64_t side = std::int64_t{1} << square.level;
  std::vector<const cube*> seen;
  const auto add = [&](const lattice_position& at, bool corner) {
    const std::optional<cube>& one = cubes.at({at, corner});
    if (one) seen.push_back(&*one);
  };
  double area = 0.0;
  for (std::int64_t z = square.z * side; z <= (square.z + 1) * side; ++z)
    for (std::int64_t x = square.x * side; x <= (square.x + 1) * side; ++x) {
      const lattice_position at{.z = z, .y = square.y, .x = x};
      add(at, true);
      if (z == (square.z + 1) * side || x == (square.x + 1) * side) continue;
      add(at, false);
      const looked_at& place = places.at(at);
      area += place.valid ? place.floor_area : 0.0;  // of a solid place nothing is drawn
    }
  return area * counts_.local().expected_union(seen, cubes_drawn[static_cast<std::size_t>(square.level)]);
}

void block_estimates::add(std::span<const view_cell* const> cells, const std::function<void()>& pause,
                          std::vector<cell_option>& options) {
  block_places places;
  for (const view_cell* cell : cells) places[cell->position].floor_area = cell->floor_area;
  std::vector<lattice_position> positions;
  for (const auto& [position, place] : places) positions.push_back(position);
  const std::vector<lattice_position> squares = squares_of(places);
  positions.insert(positions.end(), squares.begin(), squares.end());

  block_cubes cubes;
  for (const auto& [at, place] : places) {
    cubes.try_emplace({at, false});
    for (const std::int64_t z : {at.z, at.z + 1})
      for (const std::int64_t x : {at.x, at.x + 1}) cubes.try_emplace({{.z = z, .y = at.y, .x = x}, true});
  }
  std::vector<block_cubes::pointer> all;
  for (auto& entry : cubes) all.push_back(&entry);
  for (std::size_t first = 0; first < all.size(); first += cubes_at_once) {
    const std::size_t end = std::min(all.size(), first + cubes_at_once);
    const auto look_at = [&](std::size_t i) { all[i]->second = look(all[i]->first); };
    if (tools_.source.shared())
      tbb::parallel_for(first, end, look_at);
    else
      for (std::size_t i = first; i < end; ++i) look_at(i);
    pause();
  }
  for (auto& [at, place] : places) place.valid = cubes.at({at, false}).has_value();
  const std::size_t before = options.size();
  options.resize(before + positions.size());
  tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t i) {
    options[before + i] = {positions[i], drawn_from(positions[i], places, cubes)};
  });
  pause();
}

// Sorts cells along rows of cells of level 0.
bool comes_before(const view_cell& a, const view_cell& b) {
  const auto key = [](const lattice_position& p) {
    return lattice_position{.z = p.z << p.level, .y = p.y, .x = p.x << p.level, .level = p.level};
  };
  return key(a.position) < key(b.position);
}

// Returns the blocks to consider: all, or with a limit those around cells that are spread evenly over the list.
std::vector<std::uint32_t> chosen_blocks(const cell_blocks& blocks, std::uint32_t limit) {
  std::vector<std::uint32_t> chosen;
  const std::uint64_t all = blocks.cell_count();
  const std::uint64_t count = limit == 0 ? 0 : std::max(limit / cells_of_limited_block, 1u);
  for (std::uint32_t block = 0; limit == 0 && block < blocks.count(); ++block) chosen.push_back(block);
  for (std::uint64_t i = 0; i < count; ++i)
    chosen.push_back(blocks.block_of(static_cast<std::uint32_t>((2 * i + 1) * all / (2 * count))));
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

void merge_cells(cell_list& list, const settings& how, const merge_tools& tools,
                 const std::function<void(double share)>& report) {
  const lattice on(list.cell_width);
  const cell_blocks blocks(list.cells, how.margin);
  const std::vector<std::uint32_t> chosen = chosen_blocks(blocks, how.cell_limit);
  std::size_t all = 0, done = 0;
  for (const std::uint32_t block : chosen) all += blocks.cells_of(block).size();
  block_estimates estimates(on, how, tools);
  std::vector<cell_option> options;
  for (const std::uint32_t block : chosen) {
    std::vector<const view_cell*> cells;
    for (const std::uint32_t cell : blocks.cells_of(block)) cells.push_back(&list.cells[cell]);
    const auto pause = [&] { report(static_cast<double>(done) / static_cast<double>(all)); };
    estimates.add(cells, pause, options);
    done += cells.size();
  }
  list.cells.clear();
  double widest = on.width();
  for (const lattice_position& position : choose_cell_sizes(options, how.merge_cells)) {
    list.cells.push_back(on.cell(position));
    widest = std::max(widest, on.width() * static_cast<double>(1 << position.level));
  }
  std::sort(list.cells.begin(), list.cells.end(), comes_before);
  const std::string sizes = widest > on.width() ? fmt::format("{:g} to {:g} m, merged from {} of {:g} m,", on.width(),
                                                              widest, all, on.width())
                                                : fmt::format("{:g} m", on.width());
  const std::string part = chosen.size() < blocks.count()
                               ? fmt::format(" in {} of {} blocks", chosen.size(), blocks.count())
                               : std::string();
  list.how = fmt::format("{} cells of {}{} {}", list.cells.size(), sizes, part, list.where);
}

}  // namespace sightcell::bake
