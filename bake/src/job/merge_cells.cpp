#include "job/merge_cells.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "cells/cell_blocks.h"
#include "cells/cell_sizes.h"
#include "cells/floor_cells.h"
#include "cells/lattice.h"
#include "cells/merge_tree.h"
#include "search/hemicubes.h"
#include "sightcell/base/random.h"
#include "trace/viewpoint_region.h"
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
constexpr std::uint64_t most_tests = 256;        // of points, for a viewpoint in a box
constexpr std::uint64_t most_corner_tests = 32;  // for one at a corner
constexpr std::size_t cubes_at_once = 128;       // between two reports
constexpr double cubes_part = 0.95;              // of the work of a block
// Of how many blocks the cells of --cell-limit are: each has some dozen cells.
constexpr std::uint32_t cells_of_limited_block = 8;

// Ascending ids of the polygons that a full cube shows.
using cube = std::vector<std::uint32_t>;

// Where a cube is rendered: at a random valid viewpoint of a box.
struct cube_place {
  viewpoint_region where;
  std::uint64_t most_tests = 0;                   // of points
  std::uint64_t name = 0, kind = 0, of_kind = 0;  // name the random numbers
};

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

// Where cubes of a block are rendered, and which of them each node of its tree contains.
class block_cubes {
 public:
  // tree: of the cells of a block.
  block_cubes(std::span<const merge_node> tree, std::size_t cells, const lattice& on, float margin);

  std::span<const cube_place> places() const { return places_; }
  // Returns the places of a node, ascending. That of cell i is place i, inside the cell.
  std::span<const std::uint32_t> in_node(std::size_t node) const { return in_node_[node]; }

 private:
  enum place_kind : std::uint64_t { inside, corner, between };

  void add_corners(float margin);
  void add_between();
  std::uint32_t add(const viewpoint_region& where, std::uint64_t tests, std::uint64_t name, place_kind kind,
                    std::uint64_t of_kind = 0);

  const std::span<const merge_node> tree_;
  const std::size_t cells_;
  const lattice on_;
  std::vector<cube_place> places_;
  std::vector<std::vector<std::uint32_t>> in_node_;
};

std::uint32_t block_cubes::add(const viewpoint_region& where, std::uint64_t tests, std::uint64_t name, place_kind kind,
                               std::uint64_t of_kind) {
  places_.push_back({where, tests, name, kind, of_kind});
  return static_cast<std::uint32_t>(places_.size() - 1);
}

block_cubes::block_cubes(std::span<const merge_node> tree, std::size_t cells, const lattice& on, float margin)
    : tree_(tree), cells_(cells), on_(on), in_node_(tree.size()) {
  for (std::size_t i = 0; i < cells; ++i) {
    const view_cell cell = on.cell(tree[i].position);
    in_node_[i].push_back(add({cell.min, cell.max}, most_tests, cell.place, inside));
  }
  add_corners(margin);
  add_between();
}

// One cube at each corner of a column, for all cells there whose heights have a part in common.
void block_cubes::add_corners(float margin) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> at_corner;
  for (std::size_t i = 0; i < cells_; ++i) {
    const lattice_position& p = tree_[i].position;
    for (const std::int64_t z : {p.z, p.z + 1})
      for (const std::int64_t x : {p.x, p.x + 1}) at_corner[{z, x}].push_back(i);
  }
  const glm::vec3 aside{margin, 0.0f, margin};
  for (auto& [at, cells] : at_corner) {
    std::sort(cells.begin(), cells.end(), [&](std::size_t a, std::size_t b) {
      const lattice_position &p = tree_[a].position, &q = tree_[b].position;
      return std::tie(p.y, p.layers, p.z, p.x) < std::tie(q.y, q.layers, q.z, q.x);
    });
    for (std::size_t begin = 0; begin < cells.size();) {
      const auto end_of = [&](std::size_t i) { return tree_[i].position.y + tree_[i].position.layers; };
      std::int64_t low = tree_[cells[begin]].position.y, high = end_of(cells[begin]);
      std::size_t next = begin + 1;
      for (; next < cells.size() && tree_[cells[next]].position.y < high; ++next)
        low = tree_[cells[next]].position.y, high = std::min(high, end_of(cells[next]));
      const view_cell common =
          on_.cell({.z = at.first, .y = low, .x = at.second, .layers = static_cast<std::int32_t>(high - low)});
      // Within the margin of the corner: in the grown boxes of all these cells.
      const glm::vec3 bottom = common.min, top{common.min.x, common.max.y, common.min.z};
      const std::uint32_t place =
          add({bottom - aside, top + aside}, most_corner_tests, common.place, place_kind::corner);
      for (; begin < next; ++begin) in_node_[cells[begin]].push_back(place);
    }
  }
}

// As many cubes per volume as cells have, where a wider node contains more than the nodes below it.
void block_cubes::add_between() {
  std::vector<std::vector<std::size_t>> children(tree_.size());
  std::vector<bool> counts(tree_.size());  // the node or one around it may be a cell
  for (std::size_t i = tree_.size(); i-- > 0;)
    counts[i] = tree_[i].may_be_cell || (tree_[i].parent != i && counts[tree_[i].parent]);
  std::vector<std::pair<std::int64_t, std::int64_t>> layers_and_cells(tree_.size());
  for (std::size_t i = 0; i < tree_.size(); ++i) {
    auto& [layers, cells] = layers_and_cells[i];
    if (i < cells_) layers = tree_[i].position.layers, cells = 1;
    if (i >= cells_ && counts[i]) {
      const double mean = static_cast<double>(layers) / static_cast<double>(cells);
      double passed = 0.5 * mean;  // layers since the last cube
      std::uint64_t number = 0;
      for (const column_part& part : uncovered_by_children(tree_, i, children[i])) {
        const auto height = static_cast<std::int32_t>(part.end - part.first);
        const view_cell box = on_.cell({.z = part.z, .y = part.first, .x = part.x, .layers = height});
        for (passed += height; passed >= mean; passed -= mean)
          in_node_[i].push_back(
              add({box.min, box.max}, most_tests, on_.cell(tree_[i].position).place, between, number++));
      }
    }
    std::vector<std::uint32_t>& own = in_node_[i];
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    const std::size_t parent = tree_[i].parent;
    if (parent == i) continue;
    children[parent].push_back(i);
    layers_and_cells[parent].first += layers, layers_and_cells[parent].second += cells;
    in_node_[parent].insert(in_node_[parent].end(), own.begin(), own.end());
  }
}

class block_estimates {
 public:
  block_estimates(const lattice& on, const settings& how, const merge_tools& tools)
      : on_(on), how_(how), tools_(tools), counts_([&] { return cube_counts(tools.own_polygons); }) {}

  // Adds the options of a block: its cells, and the wider cells that they may become.
  // cells: those of the block.
  // pause: called several times per second with the part of the block that is done, 0 .. 1.
  // floors: receives the position and the floor of each option.
  void add(std::span<const view_cell* const> cells, const std::function<void(double part)>& pause,
           std::vector<cell_option>& options, std::vector<floor_cell>& floors);
  std::uint64_t cubes() const { return cubes_; }  // that were rendered

 private:
  std::optional<cube> look(const cube_place& at);
  std::vector<std::optional<cube>> look_at_all(std::span<const cube_place> places,
                                               const std::function<void(double part)>& pause);

  const lattice on_;
  const settings& how_;
  const merge_tools& tools_;
  tbb::enumerable_thread_specific<cube_counts> counts_;
  std::atomic<std::uint64_t> cubes_{0};
};

// Returns what a cube shows; nothing if there is no valid viewpoint.
std::optional<cube> block_estimates::look(const cube_place& at) {
  random_stream random(how_.seed, at.name, purpose::merging, at.kind, at.of_kind);
  std::uint64_t tests = 0;
  const auto eyes = draw_viewpoints(tools_.rays, at.where, how_.player_radius, 1, at.most_tests, random, tests);
  if (eyes.empty()) return std::nullopt;
  std::vector<pose> poses;
  add_cube(eyes.front(), poses);
  std::array<hemicube_view, 2> views;
  tools_.source.render(poses, views);
  ++cubes_;
  cube seen;
  for (const hemicube_view& view : views)
    for (const seen_polygon& polygon : view.seen)
      if (polygon.id < tools_.own_polygons) seen.push_back(polygon.id);
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

std::vector<std::optional<cube>> block_estimates::look_at_all(std::span<const cube_place> places,
                                                              const std::function<void(double part)>& pause) {
  std::vector<std::optional<cube>> cubes(places.size());
  for (std::size_t first = 0; first < places.size(); first += cubes_at_once) {
    const std::size_t end = std::min(places.size(), first + cubes_at_once);
    tbb::parallel_for(first, end, [&](std::size_t i) { cubes[i] = look(places[i]); });
    pause(cubes_part * static_cast<double>(end) / static_cast<double>(places.size()));
  }
  return cubes;
}

// Adds the floor of a part. The height of the whole is the mean by area.
void add_floor(floor_cell& whole, const floor_cell& part) {
  whole.area += part.area;
  if (whole.area > 0.0) whole.floor += (part.floor - whole.floor) * part.area / whole.area;
}

void block_estimates::add(std::span<const view_cell* const> cells, const std::function<void(double part)>& pause,
                          std::vector<cell_option>& options, std::vector<floor_cell>& floors) {
  std::map<lattice_position, const view_cell*> cell_at;
  for (const view_cell* cell : cells) cell_at[cell->position] = cell;
  std::vector<lattice_position> smallest;
  for (const auto& [position, cell] : cell_at) smallest.push_back(position);
  const std::vector<merge_node> tree = make_merge_tree(smallest, cell_blocks::highest_level);
  const block_cubes where(tree, smallest.size(), on_, how_.margin);
  const std::vector<std::optional<cube>> cubes = look_at_all(where.places(), pause);

  const std::size_t before = options.size();
  options.resize(before + tree.size());
  std::vector<double> areas(tree.size(), 0.0);  // of cells with a valid viewpoint: of the others nothing is drawn
  for (const merge_node& node : tree) floors.push_back({node.position});
  for (std::size_t i = 0; i < tree.size(); ++i) {
    options[before + i] = {before + tree[i].parent, i < smallest.size()};
    floor_cell& own = floors[before + i];
    if (i < smallest.size()) {
      const view_cell& cell = *cell_at[tree[i].position];
      own.area = cell.floor_area, own.floor = cell.floor;
      if (cubes[i]) areas[i] = own.area;
    }
    if (tree[i].parent == i) continue;
    areas[tree[i].parent] += areas[i];
    add_floor(floors[before + tree[i].parent], own);
  }
  tbb::parallel_for(std::size_t{0}, tree.size(), [&](std::size_t i) {
    if (!tree[i].may_be_cell) return;
    std::vector<const cube*> seen;
    for (const std::uint32_t place : where.in_node(i))
      if (cubes[place]) seen.push_back(&*cubes[place]);
    const std::size_t drawn = cubes_drawn[static_cast<std::size_t>(tree[i].position.level)];
    options[before + i].drawn = areas[i] * counts_.local().expected_union(seen, drawn);
  });
  pause(1.0);
}

// Sorts cells along rows of cells of level 0.
bool comes_before(const view_cell& a, const view_cell& b) {
  const auto key = [](const lattice_position& p) {
    return lattice_position{.z = p.z << p.level, .y = p.y, .x = p.x << p.level, .level = p.level, .layers = p.layers};
  };
  return key(a.position) < key(b.position);
}

// Returns the blocks nearest to a point that hold at least `limit` cells of the list, and at least four: those at a
// corner.
std::vector<std::uint32_t> nearest_blocks(const cell_blocks& blocks, std::span<const view_cell> cells,
                                          std::uint32_t limit, const std::array<float, 3>& point) {
  std::vector<std::pair<float, std::uint32_t>> by_distance;
  for (std::uint32_t block = 0; block < blocks.count(); ++block) {
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t cell : blocks.cells_of(block)) least = std::min(least, distance_of(cells[cell], point));
    by_distance.emplace_back(least, block);
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<std::uint32_t> chosen;
  std::size_t held = 0;
  for (const auto& [distance, block] : by_distance) {
    if (chosen.size() >= 4 && held >= limit) break;
    chosen.push_back(block);
    held += blocks.cells_of(block).size();
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
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

std::uint64_t merge_cells(cell_list& list, const settings& how, const merge_tools& tools,
                          const std::function<void(double share)>& report) {
  const lattice on = lattice::over_floors(list.cell_width);
  const cell_blocks blocks(list.cells, how.margin);
  const std::vector<std::uint32_t> chosen = how.near && how.cell_limit > 0
                                                ? nearest_blocks(blocks, list.cells, how.cell_limit, *how.near)
                                                : chosen_blocks(blocks, how.cell_limit);
  std::size_t all = 0, done = 0;
  for (const std::uint32_t block : chosen) all += blocks.cells_of(block).size();
  block_estimates estimates(on, how, tools);
  std::vector<cell_option> options;
  std::vector<floor_cell> floors;
  for (const std::uint32_t block : chosen) {
    std::vector<const view_cell*> cells;
    for (const std::uint32_t cell : blocks.cells_of(block)) cells.push_back(&list.cells[cell]);
    const auto pause = [&](double part) {
      report((static_cast<double>(done) + part * static_cast<double>(cells.size())) / static_cast<double>(all));
    };
    estimates.add(cells, pause, options, floors);
    done += cells.size();
  }
  list.cells.clear();
  double widest = on.width();
  for (const std::size_t chosen_option : choose_cell_sizes(options, how.merge_cells)) {
    const floor_cell& one = floors[chosen_option];
    list.cells.push_back(on.cell(one.position));
    list.cells.back().floor_area = one.area;
    list.cells.back().floor = one.floor;
    widest = std::max(widest, on.width() * static_cast<double>(1 << one.position.level));
  }
  std::sort(list.cells.begin(), list.cells.end(), comes_before);
  const std::string sizes = widest > on.width() ? fmt::format("{:g} to {:g} m, merged from {} of {:g} m,", on.width(),
                                                              widest, all, on.width())
                                                : fmt::format("{:g} m", on.width());
  const std::string part = chosen.size() < blocks.count()
                               ? fmt::format(" in {} of {} blocks", chosen.size(), blocks.count())
                               : std::string();
  list.how = fmt::format("{} cells of {}{} {}", list.cells.size(), sizes, part, list.where);
  return estimates.cubes();
}

}  // namespace sightcell::bake
