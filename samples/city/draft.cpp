#include "draft.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightcell::city {
namespace {

enum : std::uint64_t { stream_houses = 5, stream_props = 6, stream_trees = 7, stream_prop_meshes = 8 };

// Unit quaternion of a turn about +Y that brings +Z to the direction.
glm::dvec2 turn_to(const glm::dvec2& direction) {
  const glm::dvec2 d = unit_vector(direction);
  // Half angles without sine and cosine: cos(a/2) = sqrt((1 + cos a) / 2).
  const double w = std::sqrt(std::max(0.0, (1.0 + d.y) * 0.5));
  const double y = std::sqrt(std::max(0.0, (1.0 - d.y) * 0.5));
  return {d.x < 0.0 ? -y : y, w};
}

prop_place random_tree(const glm::dvec2& at, double base, random_stream& random) {
  static constexpr std::array<prop, 4> trees = {prop::round_tree, prop::broad_tree, prop::conifer, prop::small_tree};
  prop_place place;
  place.kind = trees[random.below(4)];
  place.at = at;
  place.base = base;
  const double dx = random.range(-1.0, 1.0), dz = random.range(-1.0, 1.0);
  if (dx * dx + dz * dz > 1e-4) place.turn = turn_to({dx, dz});
  place.scale = random.range(0.8, 1.2);
  return place;
}

class prop_planner {
 public:
  prop_planner(const draft& d, const block& b, random_stream& random) : draft_(d), block_(b), random_(random) {}

  void plan_streets(block_draft& out) {
    for (std::size_t edge = 0; edge < 4; ++edge) plan_street_side(out, edge);
  }

  void plan_square(block_draft& out) {
    const glm::dvec2 middle = centroid(block_.yard);
    out.fixed_props.push_back({prop::fountain, middle, {0, 1}, 1.0, slab_height});
    for (const double distance : {4.5, 9.0}) {
      const ring line = inset(block_.yard, {distance, distance, distance, distance});
      for (std::size_t edge = 0; edge < 4; ++edge) {
        const glm::dvec2 a = line[edge], b = line[(edge + 1) % 4];
        for (int i = 0; i < 5; ++i) {
          const glm::dvec2 at = a + (b - a) * ((i + 0.5) / 5.0);
          if (distance < 5.0) {
            add(out, random_tree(at, slab_height, random_));
          } else {
            const prop kind = random_.chance(0.5) ? prop::stall : random_.chance(0.5) ? prop::bench : prop::crate;
            add(out, {kind, at, turn_to(b - a), 1.0, slab_height});
          }
        }
      }
    }
  }

  void plan_yard(block_draft& out) {
    for (int i = 0; i < 10; ++i) {
      const double u = random_.range(0.12, 0.88), v = random_.range(0.12, 0.88);
      const glm::dvec2 a = block_.yard[0] + (block_.yard[1] - block_.yard[0]) * u;
      const glm::dvec2 b = block_.yard[3] + (block_.yard[2] - block_.yard[3]) * u;
      const glm::dvec2 at = a + (b - a) * v;
      if (i < 7) {
        add(out, random_tree(at, slab_height, random_));
      } else {
        add(out, {i == 7 ? prop::bench : prop::crate, at, turn_to(b - a), 1.0, slab_height});
      }
    }
    plan_fence(out);
  }

 private:
  // Cells that were promised to be free stay free.
  void add(block_draft& out, const prop_place& place) {
    const double r = prop_radius(place.kind) * place.scale + 0.4;
    const ring taken = {{{place.at.x - r, place.at.y - r},
                         {place.at.x - r, place.at.y + r},
                         {place.at.x + r, place.at.y + r},
                         {place.at.x + r, place.at.y - r}}};
    for (const named_cell& cell : draft_.cells) {
      if (overlap(taken, cell_ring(cell, 0.0))) return;
    }
    out.props.push_back(place);
  }

  void plan_street_side(block_draft& out, std::size_t edge) {
    const glm::dvec2 a = block_.outline[edge], b = block_.outline[(edge + 1) % 4];
    const glm::dvec2 side = b - a;
    const double length = std::sqrt(side.x * side.x + side.y * side.y);
    const glm::dvec2 along = side / length, out_normal = outward_normal(a, b);
    const double pavement = glm::dot(block_.pavement[edge] - a, out_normal);
    if (pavement < 1.2) return;  // a lane is too narrow for things
    for (double s = 5.0; s < length - 4.0; s += 6.0) {
      const glm::dvec2 at = a + along * (s + random_.range(-0.5, 0.5)) + out_normal * (pavement - 0.5);
      const double pick = random_.unit();
      if (pick < 0.3) {
        add(out, {prop::lamp, at, {0, 1}, 1.0, slab_height});
      } else if (pick < 0.6) {
        prop_place tree = random_tree(at, slab_height, random_);
        if (tree.kind == prop::broad_tree || tree.kind == prop::conifer) tree.kind = prop::small_tree;
        add(out, tree);
      } else if (pick < 0.75 && pavement > 1.6) {
        add(out, {prop::car, at + out_normal * 1.6, turn_to(along), 1.0, 0.0});
      }
    }
  }

  void plan_fence(block_draft& out) {
    out.lawn = inset(block_.yard, {3.0, 3.0, 3.0, 3.0});
    for (std::size_t edge = 0; edge < 4; ++edge) {
      const glm::dvec2 a = out.lawn[edge], b = out.lawn[(edge + 1) % 4];
      const glm::dvec2 side = b - a;
      const double length = std::sqrt(side.x * side.x + side.y * side.y);
      const glm::dvec2 along = side / length;
      if (glm::dot(side, block_.yard[(edge + 1) % 4] - block_.yard[edge]) <= 0.0 || length < 11.0) {
        out.pickets.clear();
        return;  // the yard is too small for a lawn
      }
      for (double s = 0.1; s < length - 0.1; s += 0.16) out.pickets.push_back({a + along * s, a + along * (s + 0.09)});
    }
    out.has_lawn = true;
  }

  const draft& draft_;
  const block& block_;
  random_stream& random_;
};

// A tree in every cell that shall not be empty, off its middle.
void place_cell_trees(draft& d, std::uint64_t seed) {
  random_stream random{seed, stream_trees};
  for (const named_cell& cell : d.cells) {
    if (!cell.has_tree) continue;
    const glm::dvec2 middle((cell.min.x + cell.max.x) * 0.5, (cell.min.z + cell.max.z) * 0.5);
    std::size_t nearest = 0;
    double best = 1e300;
    for (std::size_t i = 0; i < d.layout.blocks.size(); ++i) {
      const glm::dvec2 away = centroid(d.layout.blocks[i].tile) - middle;
      const double distance = glm::dot(away, away);
      if (distance < best) {
        best = distance;
        nearest = i;
      }
    }
    const double half = std::min(cell.max.x - cell.min.x, cell.max.z - cell.min.z) * 0.5;
    prop_place tree = random_tree(middle + glm::dvec2(half * 0.4, -half * 0.3), slab_height, random);
    if (d.plain) tree.kind = prop::small_tree;
    d.blocks[nearest].fixed_props.push_back(tree);
  }
}

}  // namespace

draft make_draft(std::uint32_t rows, std::uint32_t columns, bool plain, std::uint64_t seed) {
  draft d;
  d.layout = make_plan(rows, columns, seed);
  d.cells = choose_cells(d.layout, seed);
  d.plain = plain;
  random_stream mesh_seed{seed, stream_prop_meshes};
  d.prop_meshes = make_prop_meshes(mesh_seed.next());
  for (const block& b : d.layout.blocks) {
    block_draft& out = d.blocks.emplace_back();
    random_stream houses{seed, stream_houses, b.row, b.column};
    house_style plainness;
    plainness.plain = plain;
    for (const lot& place : b.lots) {
      out.houses.emplace_back("house " + std::to_string(out.houses.size() + 1), place, plainness, houses);
    }
    random_stream props{seed, stream_props, b.row, b.column};
    prop_planner planner(d, b, props);
    planner.plan_streets(out);
    if (b.is_square) {
      planner.plan_square(out);
    } else {
      planner.plan_yard(out);
    }
    props.shuffle(out.props);
  }
  place_cell_trees(d, seed);
  return d;
}

}  // namespace sightcell::city
