// Towns in a richer style: bodies first, then clutter until the number is reached.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "city.h"
#include "draft.h"
#include "dressing.h"
#include "ground.h"
#include "sightcell/base/error.h"

namespace sightcell::city {
namespace {

enum : std::uint64_t {
  stream_houses = 30,
  stream_dressing = 31,
  stream_props = 32,
  stream_choice = 33,
  stream_trees = 34
};

// A mesh, and what may yet be built into it.
struct town_part {
  mesh body;
  double lift = 0;
  std::vector<clutter_wish> wishes;
};

struct town_block {
  std::vector<town_part> parts;
  std::vector<prop_place> fixed_props, props;
};

// Something that polygons can be spent on.
struct offer {
  std::uint32_t block = 0, part = 0, index = 0;  // part past the last: a prop
  std::uint32_t cost = 0;
};

class town {
 public:
  town(const style& s, std::uint32_t rows, std::uint32_t columns, std::uint64_t seed)
      : style_(s),
        seed_(seed),
        layout_(make_plan(rows, columns, seed, s.plan)),
        relief_(s.relief_height, s.relief_length, seed),
        cells_(choose_town_cells(layout_, relief_, seed)) {
    random_stream mesh_seed{seed, stream_props};
    prop_meshes_ = make_town_prop_meshes(mesh_seed.next());
    outskirts_ = make_outskirts();
    for (const block& b : layout_.blocks) blocks_.push_back(make_block(b));
    place_cell_trees();
  }

  std::uint64_t base_polygons() const {
    std::uint64_t total = 0;
    for (const mesh& m : outskirts_) total += m.polygon_count();
    for (const town_block& b : blocks_) {
      for (const town_part& part : b.parts) total += part.body.polygon_count();
      for (const prop_place& place : b.fixed_props) total += cost_of(place);
    }
    return total;
  }

  // Takes wishes in a random order, the urgent ones first, until there are exactly `polygons`. False when it cannot.
  bool spend(std::uint64_t polygons);
  model build() &&;

 private:
  std::uint64_t cost_of(const prop_place& place) const {
    return prop_meshes_[static_cast<std::size_t>(place.kind)].polygon_count();
  }
  std::vector<mesh> make_outskirts() const;
  mesh make_town_wall() const;
  town_block make_block(const block& b) const;
  void add_house(town_block& out, const lot& place, random_stream& random, dresser& d) const;
  void add_tower(town_block& out, const lot& place, random_stream& random, dresser& d) const;
  double level_of(const ring& footprint) const;
  void place_cell_trees();
  std::array<std::vector<offer>, static_cast<std::size_t>(urgency::count)> offers() const;

  style style_;
  std::uint64_t seed_;
  plan layout_;
  relief relief_;
  std::vector<named_cell> cells_;
  std::vector<mesh> prop_meshes_;
  std::vector<mesh> outskirts_;
  std::vector<town_block> blocks_;
  bool has_extra_polygon_ = false;
};

// Doors are above the street everywhere along the front; the yard may lie a little higher than the floor.
double town::level_of(const ring& footprint) const {
  const double front = std::max(relief_.at(footprint[0]), relief_.at(footprint[1]));
  const double back = std::max(relief_.at(footprint[2]), relief_.at(footprint[3]));
  return std::max(front, back - 0.6);
}

std::vector<mesh> town::make_outskirts() const {
  mesh ground("outer ground");
  for (std::uint32_t row = 0; row < layout_.rows + 2; ++row) {
    for (std::uint32_t column = 0; column < layout_.columns + 2; ++column) {
      const bool inner = row > 0 && row <= layout_.rows && column > 0 && column <= layout_.columns;
      if (!inner) add_street_ground(ground, layout_, relief_, row, column, nullptr);
    }
  }
  mesh bridges("bridges");
  for (const bridge& b : layout_.bridges) add_bridge(bridges, b, relief_);
  std::vector<mesh> out = {std::move(ground), make_town_wall()};
  if (!layout_.bridges.empty()) out.push_back(std::move(bridges));
  return out;
}

mesh town::make_town_wall() const {
  const std::vector<glm::dvec2> rim = rim_of(layout_);
  mesh m("town wall");
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const glm::dvec2& a = rim[i];
    const glm::dvec2& b = rim[(i + 1) % rim.size()];
    const glm::dvec2 half = outward_normal(a, b) * 0.8;
    const double low = std::min(relief_.at(a), relief_.at(b)) - 2.0, high = std::max(relief_.at(a), relief_.at(b));
    m.prism(surface::stone, {a + half, b + half, b - half, a - half}, low, high + town_wall_height);
    m.column(surface::stone, at_height(a, low), 2.6, 2.2, high - low + town_wall_height + 3.0);
  }
  return m;
}

void town::add_house(town_block& out, const lot& place, random_stream& random, dresser& d) const {
  house_style houses;
  houses.floors_low = style_.floors_low;
  houses.floors_more = style_.floors_more;
  houses.base = -3.0;
  building house("house " + std::to_string(out.parts.size()), place, houses, random);
  house.lift = level_of(house.footprint());
  const window_level level = random.chance(0.5) ? window_level::bars : window_level::sill;
  for (facade& f : house.facades) {
    for (std::size_t cell = 0; cell < f.cells.size(); ++cell) {
      const bool is_ground = cell < house.columns(f.edge);
      if (is_ground && house.is_over_passage()) continue;
      f.cells[cell] = random.chance(0.94) ? level : window_level::none;
      f.balconies[cell] = f.cells[cell] != window_level::none && f.edge == 0 && !is_ground && random.chance(0.12);
    }
    if (!f.cells.empty() && f.door < house.columns(f.edge)) f.cells[f.door] = level;
  }
  house.cornices = random.below(house.floors());
  house.has_penthouse = !house.is_pitched() && random.chance(0.5);
  house.has_chimney = !house.has_penthouse && random.chance(0.8);
  if (house.is_over_passage()) house.has_penthouse = false;
  town_part part{house.build(), house.lift, {}};
  d.dress_house(house, part.wishes);
  out.parts.push_back(std::move(part));
}

void town::add_tower(town_block& out, const lot& place, random_stream& random, dresser& d) const {
  tower t("tower " + std::to_string(out.parts.size()), place, style_, random);
  t.lift = level_of(t.podium());
  town_part part{t.build(), t.lift, {}};
  d.dress_tower(t, part.wishes);
  out.parts.push_back(std::move(part));
}

town_block town::make_block(const block& b) const {
  town_block out;
  mesh ground("ground");
  add_street_ground(ground, layout_, relief_, b.row + 1, b.column + 1, &b);
  add_pavement(ground, b.pavement, relief_);
  const ring lawn = inset(b.yard, {4.0, 4.0, 4.0, 4.0});
  const glm::dvec2 width = b.yard[2] - b.yard[1], depth = b.yard[1] - b.yard[0];
  if (!b.is_square && std::min(glm::dot(width, width), glm::dot(depth, depth)) > 18.0 * 18.0) {
    add_lawn(ground, lawn, relief_);
  }
  out.parts.push_back({std::move(ground), 0, {}});
  std::vector<named_cell> near;
  const glm::dvec2 middle = centroid(b.tile);
  for (const named_cell& cell : cells_) {
    const glm::dvec2 away = glm::dvec2(cell.min.x, cell.min.z) - middle;
    if (glm::dot(away, away) < 120.0 * 120.0) near.push_back(cell);
  }
  random_stream houses{seed_, stream_houses, b.row, b.column}, dressing{seed_, stream_dressing, b.row, b.column};
  dresser d(style_, relief_, near, dressing);
  for (const lot& place : b.lots) {
    if (style_.has_towers) {
      add_tower(out, place, houses, d);
    } else {
      add_house(out, place, houses, d);
    }
  }
  town_part things{mesh("things"), 0, {}};
  d.dress_street(layout_, b, things.wishes);
  out.parts.push_back(std::move(things));
  d.furnish(b, out.props);
  if (b.is_square) {
    const glm::dvec2 at = centroid(b.yard);
    out.fixed_props.push_back({prop::fountain, at, {0, 1}, 1.0, relief_.at(at) + slab_height - 0.12});
  }
  return out;
}

void town::place_cell_trees() {
  random_stream random{seed_, stream_trees};
  for (const named_cell& cell : cells_) {
    if (!cell.has_tree) continue;
    const glm::dvec2 middle((cell.min.x + cell.max.x) * 0.5, (cell.min.z + cell.max.z) * 0.5);
    const double half = std::min(cell.max.x - cell.min.x, cell.max.z - cell.min.z) * 0.5;
    std::size_t nearest = 0;
    double best = 1e300;
    for (std::size_t i = 0; i < layout_.blocks.size(); ++i) {
      const glm::dvec2 away = centroid(layout_.blocks[i].tile) - middle;
      if (glm::dot(away, away) < best) {
        best = glm::dot(away, away);
        nearest = i;
      }
    }
    prop_place tree;
    tree.kind = random.chance(0.5) ? prop::leafy_tree : prop::young_tree;
    tree.at = middle + glm::dvec2(half * 0.4, -half * 0.3);
    tree.base = relief_.at(tree.at) + slab_height;
    blocks_[nearest].fixed_props.push_back(tree);
  }
}

std::array<std::vector<offer>, static_cast<std::size_t>(urgency::count)> town::offers() const {
  std::array<std::vector<offer>, static_cast<std::size_t>(urgency::count)> out;
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
    const town_block& b = blocks_[i];
    for (std::uint32_t p = 0; p < b.parts.size(); ++p) {
      for (std::uint32_t w = 0; w < b.parts[p].wishes.size(); ++w) {
        const clutter_wish& wish = b.parts[p].wishes[w];
        out[static_cast<std::size_t>(wish.when)].push_back(
            {i, p, w, static_cast<std::uint32_t>(clutter_cost(wish.place.kind))});
      }
    }
    const auto props = static_cast<std::uint32_t>(b.parts.size());
    for (std::uint32_t k = 0; k < b.props.size(); ++k) {
      out[static_cast<std::size_t>(urgency::wanted)].push_back(
          {i, props, k, static_cast<std::uint32_t>(cost_of(b.props[k]))});
    }
  }
  return out;
}

bool town::spend(std::uint64_t polygons) {
  const std::uint64_t base = base_polygons();
  if (polygons < base) return false;
  std::uint64_t left = polygons - base;
  has_extra_polygon_ = left % 2 == 1;
  if (has_extra_polygon_) --left;
  random_stream random{seed_, stream_choice};
  std::vector<std::vector<prop_place>> props(blocks_.size());
  for (std::vector<offer>& same : offers()) {
    random.shuffle(same);
    for (const offer& o : same) {
      if (o.cost > left) continue;
      left -= o.cost;
      town_block& b = blocks_[o.block];
      if (o.part == b.parts.size()) {
        props[o.block].push_back(b.props[o.index]);
      } else {
        town_part& part = b.parts[o.part];
        build_clutter(part.body, part.wishes[o.index].place);
      }
    }
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) blocks_[i].props = std::move(props[i]);
  return left == 0;
}

model town::build() && {
  model out;
  out.surface_count = static_cast<std::size_t>(surface::count);
  out.cells = std::move(cells_);
  out.meshes = std::move(prop_meshes_);
  const auto add = [&out](node n, std::vector<std::uint32_t>& group) {
    group.push_back(static_cast<std::uint32_t>(out.nodes.size()));
    out.nodes.push_back(std::move(n));
  };
  const auto add_mesh = [&](mesh&& m, double lift, std::vector<std::uint32_t>& group) {
    if (m.polygon_count() == 0) return;
    node n;
    n.name = m.name();
    n.mesh = static_cast<std::uint32_t>(out.meshes.size());
    n.translation = m.origin() + glm::dvec3(0, lift, 0);
    out.meshes.push_back(std::move(m));
    add(std::move(n), group);
  };
  const auto add_prop = [&](const prop_place& place, std::vector<std::uint32_t>& group) {
    node n;
    n.mesh = static_cast<std::uint32_t>(place.kind);
    n.name = out.meshes[n.mesh].name();
    n.translation = at_height(place.at, place.base);
    n.turn = place.turn;
    n.tilt = place.tilt;
    n.scale = place.scale;
    add(std::move(n), group);
  };
  const auto add_group = [&](std::string name, std::vector<std::uint32_t> children) {
    node n;
    n.name = std::move(name);
    n.children = std::move(children);
    add(std::move(n), out.roots);
  };
  std::vector<std::uint32_t> group;
  if (has_extra_polygon_) {
    // Outside the wall, where nobody comes.
    const glm::dvec2 corner = layout_.node(0, 0) - glm::dvec2(6, 6);
    const double y = relief_.at(corner);
    outskirts_[0].triangle(surface::road, at_height(corner, y), at_height(corner + glm::dvec2(0, 2), y),
                           at_height(corner + glm::dvec2(2, 0), y));
  }
  for (mesh& m : outskirts_) add_mesh(std::move(m), 0, group);
  add_group("outskirts", std::move(group));
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const block& b = layout_.blocks[i];
    group.clear();
    for (town_part& part : blocks_[i].parts) add_mesh(std::move(part.body), part.lift, group);
    for (const prop_place& place : blocks_[i].fixed_props) add_prop(place, group);
    for (const prop_place& place : blocks_[i].props) add_prop(place, group);
    add_group((b.is_square ? "square " : "block ") + std::to_string(b.row + 1) + "-" + std::to_string(b.column + 1),
              std::move(group));
  }
  return out;
}

// Square or nearly square layouts, the one with the density of the style first.
std::vector<std::pair<std::uint32_t, std::uint32_t>> layouts(double blocks) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  const auto middle = static_cast<std::uint32_t>(std::sqrt(blocks));
  for (std::uint32_t rows = middle > 2 ? middle - 2 : 1; rows <= middle + 2; ++rows) {
    for (const std::uint32_t columns : {rows, rows + 1}) out.emplace_back(rows, columns);
  }
  std::stable_sort(out.begin(), out.end(), [blocks](const auto& a, const auto& b) {
    return std::abs(1.0 * a.first * a.second - blocks) < std::abs(1.0 * b.first * b.second - blocks);
  });
  return out;
}

}  // namespace

model make_town(const style& s, std::uint64_t polygons, std::uint64_t seed) {
  for (const auto& [rows, columns] : layouts(static_cast<double>(polygons) / s.polygons_per_block)) {
    if (std::uint64_t{rows} * columns * 8000 > polygons) continue;  // not even bare walls
    town t(s, rows, columns, seed);
    if (!t.spend(polygons)) continue;
    model out = std::move(t).build();
    if (count_polygons(out) != polygons) throw std::logic_error("the town's budget and its meshes disagree");
    return out;
  }
  throw error(error_kind::failed, "city.no-plan", "a town of " + std::to_string(polygons) + " polygons",
              "no plan of seed " + std::to_string(seed) + " comes to that number",
              "try another seed or a number near a multiple of " + std::to_string(s.polygons_per_block));
}

}  // namespace sightcell::city
