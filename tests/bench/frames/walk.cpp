#include "bench/frames/walk.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "cells/walkable.h"
#include "trace/ray_scene.h"
#include "trace/viewpoints.h"

namespace sightcell::bench {
namespace {

constexpr float clearance = 0.2f;                 // meters that a walker keeps from surfaces
constexpr float probe = 0.25f;                    // meters between the places of a way that are looked at
constexpr float look_ahead = 3.0f;                // meters along the way that a walker looks at
constexpr float ease = 0.25f, most_turn = 0.14f;  // of a frame: share of what is left, radians

constexpr std::pair<int, int> sides[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};  // x and z

// Cells, where in them somebody can stand, and which of them one can walk between; looked at when it is asked for.
class walkable_graph {
 public:
  explicit walkable_graph(const scene::world_geometry& geometry) : rays_(geometry, false) {
    for (bake::view_cell& cell : bake::make_all_cells(geometry, {}).cells) {
      if (cell.on_lattice)
        in_column_[{cell.position.z, cell.position.x}].push_back(static_cast<std::uint32_t>(cells_.size()));
      cells_.push_back(std::move(cell));
    }
    places_.resize(cells_.size());
  }

  // Cells, the one nearest to a place first.
  std::vector<std::uint32_t> nearest(const glm::vec3& to) const {
    std::vector<std::uint32_t> order(cells_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto away = [&](std::uint32_t cell) {
      return glm::distance(0.5f * (cells_[cell].min + cells_[cell].max), to);
    };
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return away(a) < away(b); });
    return order;
  }

  const std::optional<glm::vec3>& place(std::uint32_t cell) {
    if (!places_[cell]) places_[cell].emplace(find_place(cells_[cell]));
    return *places_[cell];
  }

  // In the four columns beside the cell.
  std::vector<std::uint32_t> reachable(std::uint32_t from) {
    std::vector<std::uint32_t> out;
    const bake::lattice_position& p = cells_[from].position;
    for (const auto& [dx, dz] : sides) {
      const auto column = in_column_.find({p.z + dz, p.x + dx});
      if (column == in_column_.end()) continue;
      for (const std::uint32_t to : column->second)
        if (place(to) && is_passable(*place(from), *place(to))) out.push_back(to);
    }
    return out;
  }

 private:
  bool is_in_cell(const glm::vec3& p) const {
    if (cells_.empty()) return false;
    const float width = cells_[0].max.x - cells_[0].min.x;
    const auto floor_of = [&](float at) { return static_cast<std::int64_t>(std::floor(at / width)); };
    const auto column = in_column_.find({floor_of(p.z), floor_of(p.x)});
    return column != in_column_.end() &&
           std::any_of(column->second.begin(), column->second.end(),
                       [&](std::uint32_t cell) { return p.y >= cells_[cell].min.y && p.y < cells_[cell].max.y; });
  }

  // Eye height above the floor below, as near the middle as a few tries find it.
  std::optional<glm::vec3> find_place(const bake::view_cell& cell) const {
    bake::random_stream random(1, cell.place, bake::purpose::viewpoints);
    std::uint64_t tries = 0;
    const glm::vec3 middle = 0.5f * (cell.min + cell.max);
    std::vector<glm::vec3> points =
        bake::draw_viewpoints(rays_, {cell.min, cell.max}, clearance, 16, 256, random, tries);
    points.insert(points.begin(), middle);
    std::optional<glm::vec3> best;
    for (glm::vec3 p : points) {
      bake::sight below;
      rays_.trace(p, {0.0f, -1.0f, 0.0f}, below);
      if (below.front == bake::no_polygon || below.distance > 4.0f) continue;
      p.y += static_cast<float>(bake::eye_height) - below.distance;
      const auto away = [&](const glm::vec3& q) { return std::hypot(q.x - middle.x, q.z - middle.z); };
      if (p.y < cell.min.y || p.y >= cell.max.y || (best && away(p) >= away(*best))) continue;
      if (rays_.is_valid(p, clearance)) best = p;
    }
    return best;
  }

  bool is_passable(const glm::vec3& a, const glm::vec3& b) const {
    const auto steps = static_cast<int>(std::ceil(glm::distance(a, b) / probe));
    for (int i = 1; i < steps; ++i) {
      const glm::vec3 p = a + (b - a) * (static_cast<float>(i) / static_cast<float>(steps));
      if (!is_in_cell(p) || !rays_.is_valid(p, clearance)) return false;
    }
    return true;
  }

  bake::ray_scene rays_;
  std::vector<bake::view_cell> cells_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> in_column_;  // by z and x
  std::vector<std::optional<std::optional<glm::vec3>>> places_;
};

// In the thick of it: half of all corners lie on either side, along each axis.
glm::vec3 median_corner(const scene::world_geometry& geometry) {
  glm::vec3 out(0.0f);
  std::vector<float> values(geometry.indices.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = geometry.positions[geometry.indices[i]][axis];
    std::erase_if(values, [](float v) { return !std::isfinite(v); });
    if (values.empty()) continue;
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    out[axis] = *half;
    values.resize(geometry.indices.size());
  }
  return out;
}

struct walk {
  std::vector<glm::vec3> corners;
  std::size_t cells = 0;
};

walk walk_from(walkable_graph& graph, std::uint32_t start, float length, bake::random_stream& random) {
  walk out;
  std::set<std::uint32_t> entered{start};
  std::vector<std::uint32_t> way{start};
  out.corners.push_back(*graph.place(start));
  glm::vec3 heading(0.0f);
  for (float walked = 0.0f; walked < length;) {
    const glm::vec3 here = out.corners.back();
    std::optional<std::uint32_t> next;
    float best = -10.0f;
    for (const std::uint32_t cell : graph.reachable(way.back())) {
      if (entered.contains(cell)) continue;
      const float score = glm::dot(glm::normalize(*graph.place(cell) - here), heading) + 0.6f * random.uniform();
      if (score > best) {
        best = score;
        next = cell;
      }
    }
    if (next) {
      entered.insert(*next);
      way.push_back(*next);
    } else {
      way.pop_back();
      if (way.empty()) break;
    }
    out.corners.push_back(*graph.place(way.back()));
    walked += glm::distance(here, out.corners.back());
    heading = glm::normalize(out.corners.back() - here);
  }
  out.cells = entered.size();
  return out;
}

// Places of a polyline by the way to them.
class polyline {
 public:
  explicit polyline(const std::vector<glm::vec3>& corners) : corners_(corners) {
    for (std::size_t i = 0; i < corners.size(); ++i)
      ways_.push_back(i == 0 ? 0.0f : ways_.back() + glm::distance(corners[i - 1], corners[i]));
  }
  float length() const { return ways_.back(); }
  glm::vec3 at(float way) const {
    const auto behind = std::upper_bound(ways_.begin(), ways_.end(), way);
    if (behind == ways_.end()) return corners_.back();
    const auto i = static_cast<std::size_t>(behind - ways_.begin());
    const float part = (way - ways_[i - 1]) / (ways_[i] - ways_[i - 1]);
    return corners_[i - 1] + part * (corners_[i] - corners_[i - 1]);
  }

 private:
  const std::vector<glm::vec3>& corners_;
  std::vector<float> ways_;
};

}  // namespace

std::vector<path_frame> record_walk(const scene::world_geometry& geometry, const walk_settings& how) {
  walkable_graph graph(geometry);
  const float length = static_cast<float>(how.frames) * how.step;
  bake::random_stream random(how.seed, 0, bake::purpose::viewpoints);
  std::vector<std::uint32_t> starts = graph.nearest(how.near.value_or(median_corner(geometry)));
  if (starts.size() > how.starts) starts.resize(how.starts);
  walk best;
  for (const std::uint32_t start : starts) {
    if (!graph.place(start)) continue;
    walk found = walk_from(graph, start, length, random);
    if (found.cells > best.cells) best = std::move(found);
  }
  if (best.cells < 2) throw std::runtime_error("there are no two view cells that one can walk between");

  const polyline line(best.corners);
  std::vector<path_frame> path;
  for (std::uint32_t f = 0; f < how.frames && static_cast<float>(f) * how.step < line.length(); ++f) {
    const float way = static_cast<float>(f) * how.step;
    path_frame frame{line.at(way), path.empty() ? 0.0f : path.back().heading};
    const glm::vec3 ahead = line.at(way + look_ahead) - frame.eye;
    if (std::hypot(ahead.x, ahead.z) > 0.5f * probe) {
      const float turn =
          std::remainder(std::atan2(ahead.x, -ahead.z) - frame.heading, 2.0f * std::numbers::pi_v<float>);
      frame.heading += path.empty() ? turn : std::clamp(ease * turn, -most_turn, most_turn);
    }
    path.push_back(frame);
  }
  return path;
}

std::vector<bake::view_cell> cells_of(const scene::world_geometry& geometry, const std::vector<path_frame>& path,
                                      std::uint32_t& outside) {
  const std::vector<bake::view_cell> all = bake::make_all_cells(geometry, {}).cells;
  std::vector<bake::view_cell> out;
  std::set<std::size_t> taken;
  for (const path_frame& f : path) {
    const auto holds = [&](const bake::view_cell& c) {
      return f.eye.x >= c.min.x && f.eye.x < c.max.x && f.eye.y >= c.min.y && f.eye.y < c.max.y && f.eye.z >= c.min.z &&
             f.eye.z < c.max.z;
    };
    const auto found = std::find_if(all.begin(), all.end(), holds);
    if (found == all.end()) {
      ++outside;
    } else if (taken.insert(static_cast<std::size_t>(found - all.begin())).second) {
      out.push_back(*found);
    }
  }
  return out;
}

}  // namespace sightcell::bench
