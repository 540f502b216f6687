#include "city.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "draft.h"
#include "sightcell/base/error.h"

namespace sightcell::city {
namespace {

constexpr std::uint64_t fewest_with_windows = 4000;

class model_builder {
 public:
  explicit model_builder(const draft& d) : draft_(d) {
    out_.cells = d.cells;
    for (const mesh& m : d.prop_meshes) out_.meshes.push_back(m);
  }

  model build() {
    out_.roots.push_back(add_group("outskirts", outskirts()));
    for (std::size_t i = 0; i < draft_.blocks.size(); ++i) {
      const block& b = draft_.layout.blocks[i];
      const std::string kind = b.is_square ? "square " : "block ";
      out_.roots.push_back(add_group(kind + std::to_string(b.row + 1) + "-" + std::to_string(b.column + 1),
                                     block_nodes(b, draft_.blocks[i])));
    }
    return std::move(out_);
  }

 private:
  std::uint32_t add_node(node n) {
    out_.nodes.push_back(std::move(n));
    return static_cast<std::uint32_t>(out_.nodes.size() - 1);
  }

  std::uint32_t add_group(const std::string& name, std::vector<std::uint32_t> children) {
    node n;
    n.name = name;
    n.children = std::move(children);
    return add_node(std::move(n));
  }

  std::uint32_t add_mesh(mesh m) {
    node n;
    n.name = m.name();
    n.mesh = static_cast<std::uint32_t>(out_.meshes.size());
    n.translation = m.origin();
    out_.meshes.push_back(std::move(m));
    return add_node(std::move(n));
  }

  std::uint32_t add_prop(const prop_place& place) {
    node n;
    n.mesh = static_cast<std::uint32_t>(place.kind);
    n.name = out_.meshes[n.mesh].name();
    n.translation = at_height(place.at, place.base);
    n.turn = place.turn;
    n.scale = place.scale;
    return add_node(std::move(n));
  }

  // The ring of ground around the outermost streets, and the town wall on its rim.
  std::vector<std::uint32_t> outskirts() {
    const plan& p = draft_.layout;
    mesh ground("outer ground");
    for (std::uint32_t row = 0; row < p.rows + 2; ++row) {
      for (std::uint32_t column = 0; column < p.columns + 2; ++column) {
        const bool inner = row > 0 && row <= p.rows && column > 0 && column <= p.columns;
        if (!inner) add_ground(ground, row, column, draft_.has_extra_polygon && row == 0 && column == 0);
      }
    }
    std::vector<std::uint32_t> out = {add_mesh(std::move(ground))};
    if (!draft_.plain) out.push_back(add_mesh(town_wall()));
    return out;
  }

  void add_ground(mesh& m, std::uint32_t row, std::uint32_t column, bool has_extra) {
    const plan& p = draft_.layout;
    const glm::dvec3 a = at_height(p.node(row, column), 0), b = at_height(p.node(row + 1, column), 0);
    const glm::dvec3 c = at_height(p.node(row + 1, column + 1), 0), d = at_height(p.node(row, column + 1), 0);
    if (!has_extra) {
      m.quad(surface::road, a, b, c, d);
      return;
    }
    // The rim of the city has no neighbor, so an edge can be split there without a T-junction.
    const glm::dvec3 middle = (a + b) * 0.5;
    m.triangle(surface::road, a, middle, d);
    m.triangle(surface::road, middle, b, c);
    m.triangle(surface::road, middle, c, d);
  }

  mesh town_wall() {
    const std::vector<glm::dvec2> rim = rim_of(draft_.layout);
    mesh m("town wall");
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const glm::dvec2& a = rim[i];
      const glm::dvec2& b = rim[(i + 1) % rim.size()];
      const glm::dvec2 half = outward_normal(a, b) * 0.8;
      m.prism(surface::stone, {a + half, b + half, b - half, a - half}, -0.5, town_wall_height);
      m.column(surface::stone, at_height(a, -0.5), 2.6, 2.2, town_wall_height + 3.0);
    }
    return m;
  }

  std::vector<std::uint32_t> block_nodes(const block& b, const block_draft& content) {
    std::vector<std::uint32_t> out;
    mesh ground("ground");
    add_ground(ground, b.row + 1, b.column + 1, false);
    ground.prism(surface::pavement, b.pavement, -0.2, slab_height);
    if (content.has_lawn) ground.prism(surface::lawn, content.lawn, 0.0, slab_height + 0.03);
    out.push_back(add_mesh(std::move(ground)));
    for (const building& house : content.houses) out.push_back(add_mesh(house.build()));
    if (content.pickets_used != 0) out.push_back(add_mesh(fence(content)));
    for (const prop_place& place : content.fixed_props) out.push_back(add_prop(place));
    for (std::size_t i = 0; i < content.props_used; ++i) out.push_back(add_prop(content.props[i]));
    return out;
  }

  static mesh fence(const block_draft& content) {
    mesh m("fence");
    for (std::size_t i = 0; i < content.pickets_used; ++i) {
      const auto& [a, b] = content.pickets[i];
      m.quad(surface::fence, at_height(a, slab_height + 0.08), at_height(b, slab_height + 0.08), at_height(b, 1.1),
             at_height(a, 1.1));
    }
    return m;
  }

  const draft& draft_;
  model out_;
};

// The smallest square or nearly square town that has room for about twice as many polygons, so that detail stops at
// window sills; where the bare walls of that town are too many already, the smallest that has room at all.
bool find_draft(std::uint64_t polygons, std::uint64_t seed, draft& out) {
  const bool plain = polygons < fewest_with_windows;
  for (const double filled : {0.45, 1.0}) {
    std::uint32_t side = 1;
    // About 18,000 polygons fit into a block: start below, so that few drafts are made.
    while (!plain && std::uint64_t{side} * side * 20000 < polygons / 2) ++side;
    for (; side < 200; ++side) {
      bool too_large = true;
      for (const std::uint32_t columns : {side, side + 1}) {
        draft d = make_draft(side, columns, plain, seed);
        if (base_polygons(d) > polygons) continue;
        too_large = false;
        if (static_cast<double>(possible_polygons(d)) * filled < static_cast<double>(polygons)) continue;
        if (!spend(d, polygons, seed)) continue;
        out = std::move(d);
        return true;
      }
      if (too_large) break;
    }
  }
  return false;
}

}  // namespace

std::uint64_t count_polygons(const model& m) {
  std::vector<std::uint64_t> of_mesh;
  for (const mesh& part : m.meshes) of_mesh.push_back(part.polygon_count());
  std::uint64_t total = 0;
  for (const node& n : m.nodes) {
    if (n.mesh < of_mesh.size()) total += of_mesh[n.mesh];
  }
  return total;
}

model make_city(std::uint64_t polygons, std::uint64_t seed) {
  if (polygons < fewest_polygons || polygons > most_polygons) {
    throw error(error_kind::wrong_use, "city.polygons", "a city of " + std::to_string(polygons) + " polygons",
                "the number is out of range",
                "ask for " + std::to_string(fewest_polygons) + " to " + std::to_string(most_polygons));
  }
  draft d;
  if (!find_draft(polygons, seed, d)) {
    throw error(error_kind::failed, "city.no-plan", "a city of " + std::to_string(polygons) + " polygons",
                "no plan of seed " + std::to_string(seed) + " comes to that number", "try another seed");
  }
  model out = model_builder(d).build();
  if (count_polygons(out) != polygons) throw std::logic_error("the city's budget and its meshes disagree");
  return out;
}

}  // namespace sightcell::city
