#include "cells.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <optional>

#include "ground.h"
#include "random.h"

namespace sightcell::city {
namespace {

enum : std::uint64_t { stream_cells = 4 };

constexpr double cell_low = 0.5, cell_high = 3.0;
constexpr double clearance = 0.5;  // to the nearest house: more than the bake's default margin and sills together

struct candidate {
  std::string kind;
  glm::dvec2 center{0, 0};
  bool has_tree = false;
  double largest = 8.0;  // meters that it may be wide
};

bool is_free(const plan& p, const named_cell& cell, bool is_passage) {
  const ring grown = cell_ring(cell, clearance);
  for (const block& b : p.blocks) {
    const glm::dvec2 d = centroid(b.tile) - centroid(grown);
    if (d.x * d.x + d.y * d.y > 120.0 * 120.0) continue;
    for (const lot& l : b.lots) {
      if (is_passage && l.is_over_passage) continue;
      if (overlap(grown, l.footprint)) return false;
    }
  }
  return true;
}

// The largest of a few boxes around the place that no house reaches into.
std::optional<named_cell> fit(const plan& p, const candidate& place) {
  static constexpr double sizes[][2] = {{8, 8},     {7, 8},     {8, 7},     {7, 7},     {6, 8},    {8, 6}, {5, 8},
                                        {8, 5},     {6, 6},     {4, 8},     {8, 4},     {5, 5},    {4, 4}, {3.2, 6.0},
                                        {6.0, 3.2}, {3.2, 3.2}, {2.0, 5.0}, {5.0, 2.0}, {2.0, 2.0}};
  const bool is_passage = place.kind == "passage";
  for (const auto& size : sizes) {
    if (size[0] > place.largest || size[1] > place.largest || (size[0] * size[1] < 10.0 && !is_passage)) continue;
    named_cell cell;
    cell.name = place.kind;
    cell.min = {place.center.x - size[0] * 0.5, cell_low, place.center.y - size[1] * 0.5};
    cell.max = {place.center.x + size[0] * 0.5, cell_high, place.center.y + size[1] * 0.5};
    cell.has_tree = place.has_tree;
    if (is_free(p, cell, is_passage)) return cell;
  }
  return std::nullopt;
}

std::map<std::string, std::vector<candidate>> find_candidates(const plan& p, random_stream& random) {
  std::map<std::string, std::vector<candidate>> out;
  for (const glm::dvec2& c : p.crossings) out["crossroads"].push_back({"crossroads", c});
  for (const street& s : p.streets) {
    if (s.is_sunken) {
      out["sunken street"].push_back({"sunken street", (s.from + s.to) * 0.5, false, 6.0});
      continue;
    }
    const std::string kind = s.width < 9.0 ? "lane" : "street";
    out[kind].push_back({kind, (s.from + s.to) * 0.5});
  }
  for (const bridge& b : p.bridges) {
    out["on bridge"].push_back({"on bridge", b.over, false, 4.0});
    out["under bridge"].push_back({"under bridge", b.over, false, 6.0});
  }
  for (const block& b : p.blocks) {
    for (const lot& l : b.lots) {
      if (l.is_over_passage) out["passage"].push_back({"passage", centroid(l.footprint), false, 5.0});
    }
    const glm::dvec2 middle = centroid(b.yard);
    if (b.is_square) {
      out["square"].push_back({"square", middle + glm::dvec2(-9.0, -6.0), true});
      out["square"].push_back({"square", middle + glm::dvec2(9.0, 6.0), false});
    } else {
      out["courtyard"].push_back({"courtyard", middle, random.chance(0.6)});
    }
  }
  for (auto& [kind, places] : out) random.shuffle(places);
  return out;
}

}  // namespace

ring cell_ring(const named_cell& cell, double grown) {
  const double x0 = cell.min.x - grown, x1 = cell.max.x + grown;
  const double z0 = cell.min.z - grown, z1 = cell.max.z + grown;
  return {{{x0, z0}, {x0, z1}, {x1, z1}, {x1, z0}}};
}

namespace {

struct quota {
  const char* kind;
  std::size_t count;
};

std::vector<named_cell> choose(const plan& p, const std::vector<quota>& quotas, std::uint64_t seed) {
  random_stream random{seed, stream_cells};
  std::map<std::string, std::vector<candidate>> places = find_candidates(p, random);
  std::vector<named_cell> cells;
  std::map<std::string, std::uint32_t> numbers;
  const auto take = [&](const std::string& kind, std::size_t wanted) {
    std::vector<candidate>& open = places[kind];
    while (wanted > 0 && !open.empty() && cells.size() < cell_count) {
      auto cell = fit(p, open.back());
      open.pop_back();
      if (!cell) continue;
      cell->name.append(" ").append(std::to_string(++numbers[kind]));
      cells.push_back(*std::move(cell));
      --wanted;
    }
  };
  for (const quota& q : quotas) take(q.kind, q.count);
  for (const char* kind : {"courtyard", "lane", "street", "crossroads"}) take(kind, cell_count);
  // At least four cells are not empty: where the draw gave fewer, courtyards get a tree.
  auto with_tree = std::count_if(cells.begin(), cells.end(), [](const named_cell& c) { return c.has_tree; });
  for (named_cell& cell : cells) {
    if (with_tree >= 4) break;
    if (cell.has_tree || !cell.name.starts_with("courtyard")) continue;
    cell.has_tree = true;
    ++with_tree;
  }
  return cells;
}

// The ground below a cell: the highest of its corners and its middle.
double ground_of(const named_cell& cell, const relief& r) {
  double high = r.at({(cell.min.x + cell.max.x) * 0.5, (cell.min.z + cell.max.z) * 0.5});
  for (const glm::dvec2& corner : cell_ring(cell, 0.0)) high = std::max(high, r.at(corner));
  return high;
}

}  // namespace

std::vector<named_cell> choose_cells(const plan& p, std::uint64_t seed) {
  return choose(p, {{"crossroads", 6}, {"lane", 4}, {"street", 2}, {"square", 4}, {"courtyard", 4}}, seed);
}

std::vector<named_cell> choose_town_cells(const plan& p, const relief& r, std::uint64_t seed) {
  std::vector<named_cell> cells = choose(p,
                                         {{"on bridge", 1},
                                          {"under bridge", 1},
                                          {"sunken street", 1},
                                          {"passage", 1},
                                          {"crossroads", 5},
                                          {"lane", 4},
                                          {"street", 2},
                                          {"square", 3},
                                          {"courtyard", 2}},
                                         seed);
  for (named_cell& cell : cells) {
    double low = ground_of(cell, r) + 0.3;
    if (cell.name.starts_with("under bridge") || cell.name.starts_with("sunken")) low -= sunken_depth;
    if (cell.name.starts_with("on bridge")) {
      for (const bridge& b : p.bridges) {
        const glm::dvec2 away = b.over - glm::dvec2(cell.min.x + cell.max.x, cell.min.z + cell.max.z) * 0.5;
        if (glm::dot(away, away) < 0.01) low = bridge_height(b, r) + 0.2;
      }
    }
    cell.min.y = low;
    cell.max.y = low + cell_high - cell_low;
  }
  return cells;
}

}  // namespace sightcell::city
