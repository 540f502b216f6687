#include "plan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "random.h"

namespace sightcell::city {
namespace {

enum : std::uint64_t { stream_widths = 1, stream_nodes = 2, stream_block = 3 };

constexpr double ground_ring = 8.0;    // from the outermost crossings to the town wall
constexpr double passage_width = 3.6;  // from the street into the courtyard

// Widths of parallel streets: lanes and wide streets alternate so that small cities have both.
std::vector<double> street_widths(std::uint32_t lines, const plan_style& style, random_stream& random) {
  const std::uint32_t start = random.below(4);
  std::vector<double> out(lines);
  for (std::uint32_t i = 0; i < lines; ++i) {
    out[i] = i == 0 || i + 1 == lines ? style.boundary_width : style.street_widths[(start + i) % 4];
  }
  return out;
}

std::vector<double> line_positions(std::uint32_t lines, const plan_style& style, random_stream& random) {
  std::vector<double> out(lines);
  for (std::uint32_t i = 1; i < lines; ++i) out[i] = out[i - 1] + random.range(style.block_low, style.block_high);
  const double middle = out.back() * 0.5;
  for (double& position : out) position -= middle;
  return out;
}

// Streets along x by number; never the two on the rim.
bool is_sunken(const plan& p, const plan_style& style, std::uint32_t line) {
  return style.sunken_every != 0 && line > 0 && line < p.rows && line % style.sunken_every == style.sunken_every / 2;
}

// Every second node is pushed aside by more than half a street's width: no street can be looked along for more than
// two blocks, which is what keeps the visible part small.
void place_nodes(plan& p, const plan_style& style, std::uint64_t seed) {
  random_stream random{seed, stream_nodes};
  const std::vector<double> xs = line_positions(p.columns + 1, style, random);
  const std::vector<double> zs = line_positions(p.rows + 1, style, random);
  p.nodes.resize(std::size_t{p.rows + 3} * (p.columns + 3));
  const auto at = [&p](std::uint32_t row, std::uint32_t column) -> glm::dvec2& {
    return p.nodes[row * (p.columns + 3) + column];
  };
  for (std::uint32_t row = 0; row <= p.rows; ++row) {
    for (std::uint32_t column = 0; column <= p.columns; ++column) {
      glm::dvec2 node(xs[column], zs[row]);
      node.x += (row % 2 == 0 ? -5.5 : 5.5) + random.range(-2.0, 2.0);
      node.y += (column % 2 == 0 ? -5.5 : 5.5) + random.range(-2.0, 2.0);
      at(row + 1, column + 1) = node;
      if (!is_sunken(p, style, row)) p.crossings.push_back(node);
    }
  }
  for (std::uint32_t row = 1; row <= p.rows + 1; ++row) {
    at(row, 0) = at(row, 1) - glm::dvec2(ground_ring, 0);
    at(row, p.columns + 2) = at(row, p.columns + 1) + glm::dvec2(ground_ring, 0);
  }
  for (std::uint32_t column = 0; column <= p.columns + 2; ++column) {
    at(0, column) = at(1, column) - glm::dvec2(0, ground_ring);
    at(p.rows + 2, column) = at(p.rows + 1, column) + glm::dvec2(0, ground_ring);
  }
}

void add_lot(block& b, const ring& footprint, random_stream& random) {
  lot l;
  l.footprint = footprint;
  if (random.chance(0.25)) l.front_setback = random.range(0.6, 2.4);
  b.lots.push_back(l);
}

// One edge of a block becomes a closed row of houses; party walls are square to the street, the two at the ends are
// mitred with the next edge's. Most blocks have one passage into the yard.
void add_lots_of_edge(block& b, std::size_t edge, bool has_passage, const plan_style& style, random_stream& random) {
  const glm::dvec2 outer_a = b.outline[edge], outer_b = b.outline[(edge + 1) % 4];
  const glm::dvec2 inner_a = b.yard[edge], inner_b = b.yard[(edge + 1) % 4];
  const glm::dvec2 along = unit_vector(outer_b - outer_a);
  const glm::dvec2 inward = -outward_normal(outer_a, outer_b);
  const double first = glm::dot(inner_a - outer_a, along) + 3.0;
  const double last = glm::dot(inner_b - outer_a, along) - 3.0;
  const double passage = has_passage ? passage_width : 0.0;
  const double length = last - first - passage;
  std::vector<std::array<double, 2>> rows;  // [from, to] along the edge; the passage lies between two of them
  double passage_start = 0;
  const auto count = static_cast<std::uint32_t>(std::max(1.0, std::floor(length / style.lot_width)));
  const std::uint32_t before_passage = 1 + random.below(count);
  std::vector<double> weights;
  double total = 0;
  for (std::uint32_t i = 0; i < count; ++i) total += weights.emplace_back(random.range(0.8, 1.25));
  double position = first;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (has_passage && i + 1 == before_passage) {
      passage_start = position;
      position += passage;
    }
    const double end = i + 1 == count ? last : position + length * weights[i] / total;
    rows.push_back({position, end});
    position = end;
  }
  const auto outer = [&](double s) { return outer_a + along * s; };
  const auto inner = [&](double s) { return outer_a + along * s + inward * style.building_depth; };
  add_lot(b, {outer_a, outer(first), inner(first), inner_a}, random);
  for (const auto& [from, to] : rows) add_lot(b, {outer(from), outer(to), inner(to), inner(from)}, random);
  add_lot(b, {outer(last), outer_b, inner_b, inner(last)}, random);
  if (has_passage && style.has_covered_passages) {
    const double end = passage_start + passage;
    lot over;
    over.footprint = {outer(passage_start), outer(end), inner(end), inner(passage_start)};
    over.is_over_passage = true;
    b.lots.push_back(over);
  }
}

void add_block(plan& p, std::uint32_t row, std::uint32_t column, const std::array<double, 4>& widths,
               const plan_style& style, std::uint64_t seed) {
  random_stream random{seed, stream_block, row, column};
  block b;
  b.row = row;
  b.column = column;
  b.tile = {p.node(row + 1, column + 1), p.node(row + 2, column + 1), p.node(row + 2, column + 2),
            p.node(row + 1, column + 2)};
  std::array<double, 4> to_building{}, to_pavement{};
  for (std::size_t k = 0; k < 4; ++k) {
    to_building[k] = widths[k] * 0.5;
    to_pavement[k] = to_building[k] - std::min(2.0, widths[k] * 0.15);
  }
  b.is_sunken_low = is_sunken(p, style, row);
  b.is_sunken_high = is_sunken(p, style, row + 1);
  b.pavement = inset(b.tile, to_pavement);
  b.outline = inset(b.tile, to_building);
  // Squares inside the town, about one block in seven, never two side by side.
  const bool is_inner = row > 0 && row + 1 < p.rows && column > 0 && column + 1 < p.columns;
  b.is_square = is_inner && (row * 3 + column * 2) % 7 == 5;
  const double depth = style.building_depth;
  b.yard = b.is_square ? b.outline : inset(b.outline, {depth, depth, depth, depth});
  if (!b.is_square) {
    const std::uint32_t passage_edge = random.below(6);  // 4 and 5: none
    for (std::size_t edge = 0; edge < 4; ++edge) add_lots_of_edge(b, edge, edge == passage_edge, style, random);
  }
  p.blocks.push_back(std::move(b));
}

}  // namespace

std::vector<glm::dvec2> rim_of(const plan& p) {
  std::vector<glm::dvec2> rim;
  for (std::uint32_t row = 0; row < p.rows + 2; ++row) rim.push_back(p.node(row, 0));
  for (std::uint32_t column = 0; column < p.columns + 2; ++column) rim.push_back(p.node(p.rows + 2, column));
  for (std::uint32_t row = p.rows + 2; row > 0; --row) rim.push_back(p.node(row, p.columns + 2));
  for (std::uint32_t column = p.columns + 2; column > 0; --column) rim.push_back(p.node(0, column));
  return rim;
}

plan make_plan(std::uint32_t rows, std::uint32_t columns, std::uint64_t seed, const plan_style& style) {
  plan p;
  p.rows = rows;
  p.columns = columns;
  place_nodes(p, style, seed);
  random_stream random{seed, stream_widths};
  const std::vector<double> across = street_widths(columns + 1, style, random);  // streets that run along z
  std::vector<double> along = street_widths(rows + 1, style, random);            // streets that run along x
  for (std::uint32_t line = 0; line <= rows; ++line) {
    if (is_sunken(p, style, line)) along[line] = style.sunken_width;
  }
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      // Edges of a tile in up order: its low-x side, high-z side, high-x side, low-z side.
      add_block(p, row, column, {across[column], along[row + 1], across[column + 1], along[row]}, style, seed);
    }
  }
  for (std::uint32_t row = 0; row <= rows; ++row) {
    for (std::uint32_t column = 0; column <= columns; ++column) {
      const glm::dvec2 here = p.node(row + 1, column + 1);
      const bool sunken = is_sunken(p, style, row);
      if (column < columns) p.streets.push_back({here, p.node(row + 1, column + 2), along[row], sunken});
      if (row < rows) p.streets.push_back({here, p.node(row + 2, column + 1), across[column], false});
      if (!sunken || column == 0 || column == columns) continue;
      const glm::dvec2 low = here + unit_vector(p.node(row, column + 1) - here) * sunken_half_width;
      const glm::dvec2 high = here + unit_vector(p.node(row + 2, column + 1) - here) * sunken_half_width;
      p.bridges.push_back({low, here, high, std::min(across[column] - 0.6, 10.0)});
    }
  }
  return p;
}

}  // namespace sightcell::city
