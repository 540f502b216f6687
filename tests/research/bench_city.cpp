// bench_city SCENE...: what scenes are made of: how long, thin, small, tilted and close together their polygons are,
// and how the ground lies. Prints one table with a column per scene; shares are of all polygons that have an area.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace {

using sightcell::scene::scene;
using sightcell::scene::world_geometry;

constexpr double degrees_2 = 0.03489949670250097;  // sine of two degrees
constexpr std::array<double, 6> lengths = {0.03, 0.1, 0.3, 1.0, 3.0, 10.0};
constexpr std::array<double, 5> aspects = {2, 5, 10, 20, 50};

struct row {
  std::string name;
  double value = 0;
  bool is_share = true;
};

// Counts per bin; the last bin is open.
template <std::size_t N>
class histogram {
 public:
  explicit histogram(const std::array<double, N>& limits) : limits_(limits) {}
  void add(double value, std::uint64_t weight = 1) {
    const auto bin = std::upper_bound(limits_.begin(), limits_.end(), value) - limits_.begin();
    counts_[static_cast<std::size_t>(bin)] += weight;
    total_ += weight;
  }
  void print(const std::string& what, const std::string& unit, std::vector<row>& out) const {
    for (std::size_t i = 0; i <= N; ++i) {
      const double limit = limits_[std::min(i, N - 1)];
      std::string number = std::to_string(limit);
      number.erase(number.find_last_not_of('0') + 1);
      if (number.back() == '.') number.pop_back();
      const std::string range = (i < N ? "below " : "from ") + number + unit;
      out.push_back({what + ", " + range, share(i), true});
    }
  }
  double share(std::size_t bin) const {
    return total_ == 0 ? 0.0 : static_cast<double>(counts_[bin]) / static_cast<double>(total_);
  }

 private:
  std::array<double, N> limits_;
  std::array<std::uint64_t, N + 1> counts_{};
  std::uint64_t total_ = 0;
};

struct triangle {
  std::array<glm::dvec3, 3> p;
  glm::dvec3 normal() const { return glm::cross(p[1] - p[0], p[2] - p[0]); }
  double longest() const {
    return std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
  }
};

triangle triangle_of(const world_geometry& w, std::size_t polygon) {
  const std::uint32_t* i = &w.indices[polygon * 3];
  return {{glm::dvec3(w.positions[i[0]]), glm::dvec3(w.positions[i[1]]), glm::dvec3(w.positions[i[2]])}};
}

std::vector<std::uint32_t> weld(const world_geometry& w) {
  struct hash {
    std::size_t operator()(const std::array<float, 3>& p) const {
      std::size_t h = 0;
      for (const float f : p) h = (h ^ std::hash<float>()(f)) * 0x9E3779B97F4A7C15u;
      return h;
    }
  };
  std::unordered_map<std::array<float, 3>, std::uint32_t, hash> seen;
  seen.reserve(w.positions.size());
  std::vector<std::uint32_t> out(w.positions.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const glm::vec3& p = w.positions[i];
    out[i] = seen.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(seen.size())).first->second;
  }
  return out;
}

// Pieces: polygons joined by corners in the same place. Their size: the longest side of their bounding box.
void measure_pieces(const world_geometry& w, std::vector<row>& out) {
  const std::vector<std::uint32_t> corner = weld(w);
  std::vector<std::uint32_t> parent(corner.size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root = [&parent](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < w.indices.size(); i += 3) {
    for (std::size_t k = 1; k < 3; ++k) parent[root(corner[w.indices[i + k]])] = root(corner[w.indices[i]]);
  }
  std::vector<glm::vec3> low(parent.size(), glm::vec3(1e30f)), high(parent.size(), glm::vec3(-1e30f));
  for (std::size_t i = 0; i < corner.size(); ++i) {
    const std::uint32_t r = root(corner[i]);
    low[r] = glm::min(low[r], w.positions[i]);
    high[r] = glm::max(high[r], w.positions[i]);
  }
  histogram<lengths.size()> sizes(lengths);
  for (std::size_t i = 0; i < w.kinds.size(); ++i) {
    if (w.kinds[i].absent) continue;
    const std::uint32_t r = root(corner[w.indices[i * 3]]);
    const glm::vec3 size = high[r] - low[r];
    sizes.add(std::max({size.x, size.y, size.z}));
  }
  sizes.print("piece", " m", out);
  out.push_back({"in pieces below 0.3 m", sizes.share(0) + sizes.share(1) + sizes.share(2), true});
}

void measure_shapes(const world_geometry& w, std::vector<row>& out) {
  histogram<lengths.size()> edges(lengths);
  histogram<aspects.size()> thinness(aspects);
  std::uint64_t level = 0, upright = 0, tilted = 0, off_axis = 0, total = 0;
  for (std::size_t i = 0; i < w.kinds.size(); ++i) {
    if (w.kinds[i].absent) continue;
    const triangle t = triangle_of(w, i);
    const glm::dvec3 n = t.normal();
    const double longest = t.longest(), area2 = glm::length(n);
    ++total;
    edges.add(longest);
    thinness.add(longest * longest / area2);
    const double up = std::abs(n.y) / area2, flat = std::sqrt(n.x * n.x + n.z * n.z) / area2;
    if (flat < degrees_2) {
      ++level;
    } else if (up < degrees_2) {
      ++upright;
      if (std::min(std::abs(n.x), std::abs(n.z)) > degrees_2 * flat * area2) ++off_axis;
    } else {
      ++tilted;
    }
  }
  const auto share = [total](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(total); };
  edges.print("longest edge", " m", out);
  out.push_back({"polygons below 0.3 m themselves", edges.share(0) + edges.share(1) + edges.share(2), true});
  thinness.print("longest edge / height", "", out);
  out.push_back({"level within 2 degrees", share(level), true});
  out.push_back({"upright within 2 degrees, along x or z", share(upright - off_axis), true});
  out.push_back({"upright within 2 degrees, turned", share(off_axis), true});
  out.push_back({"tilted", share(tilted), true});
}

// Of a few thousand polygons spread over the scene: has its middle another polygon in front or behind that is nearly
// parallel, and how far is the nearest?
class neighbor_search {
 public:
  neighbor_search(const world_geometry& w, std::size_t samples) : w_(w) {
    const std::size_t step = std::max<std::size_t>(1, w.kinds.size() / samples);
    for (std::size_t i = step / 2; i < w.kinds.size(); i += step) {
      if (w.kinds[i].absent) continue;
      const triangle t = triangle_of(w, i);
      const glm::dvec3 middle = (t.p[0] + t.p[1] + t.p[2]) / 3.0;
      points_.push_back({i, middle, glm::normalize(t.normal()), reach});
      grid_[key(middle)].push_back(static_cast<std::uint32_t>(points_.size() - 1));
    }
  }

  void print(std::vector<row>& out) {
    for (std::size_t i = 0; i < w_.kinds.size(); ++i) {
      if (!w_.kinds[i].absent) compare(i);
    }
    static constexpr std::array<double, 3> limits = {0.0002, 0.005, 0.03};
    histogram<limits.size()> gaps(limits);
    for (const point& p : points_) gaps.add(p.nearest);
    out.push_back({"coincident with another (0.2 mm)", gaps.share(0), true});
    out.push_back({"nearly coplanar with another, 0.2 to 5 mm off", gaps.share(1), true});
    out.push_back({"nearly coplanar with another, 5 to 30 mm off", gaps.share(2), true});
  }

 private:
  static constexpr double reach = 0.031, cell = 0.5;
  struct point {
    std::size_t polygon;
    glm::dvec3 middle, normal;
    double nearest;
  };

  static std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
    return (static_cast<std::uint64_t>(x) & 0x1FFFFF) << 42 | (static_cast<std::uint64_t>(y) & 0x1FFFFF) << 21 |
           (static_cast<std::uint64_t>(z) & 0x1FFFFF);
  }
  static std::uint64_t key(const glm::dvec3& p) {
    const glm::dvec3 c = glm::floor(p / cell);
    return key_of(static_cast<std::int64_t>(c.x), static_cast<std::int64_t>(c.y), static_cast<std::int64_t>(c.z));
  }

  void compare(std::size_t polygon) {
    const triangle t = triangle_of(w_, polygon);
    const glm::dvec3 low = glm::floor((glm::min(t.p[0], glm::min(t.p[1], t.p[2])) - reach) / cell);
    const glm::dvec3 high = glm::floor((glm::max(t.p[0], glm::max(t.p[1], t.p[2])) + reach) / cell);
    const glm::dvec3 size = high - low + 1.0;
    const glm::dvec3 n = glm::normalize(t.normal());
    if (size.x * size.y * size.z > static_cast<double>(points_.size())) {
      for (point& p : points_) measure(p, polygon, t, n);
      return;
    }
    for (auto x = static_cast<std::int64_t>(low.x); x <= static_cast<std::int64_t>(high.x); ++x) {
      for (auto y = static_cast<std::int64_t>(low.y); y <= static_cast<std::int64_t>(high.y); ++y) {
        for (auto z = static_cast<std::int64_t>(low.z); z <= static_cast<std::int64_t>(high.z); ++z) {
          const auto found = grid_.find(key_of(x, y, z));
          if (found == grid_.end()) continue;
          for (const std::uint32_t i : found->second) measure(points_[i], polygon, t, n);
        }
      }
    }
  }

  static void measure(point& p, std::size_t polygon, const triangle& t, const glm::dvec3& n) {
    if (p.polygon == polygon || std::abs(glm::dot(p.normal, n)) < 0.9994) return;
    const double distance = std::abs(glm::dot(p.middle - t.p[0], n));
    if (distance >= p.nearest) return;
    for (std::size_t k = 0; k < 3; ++k) {
      if (glm::dot(glm::cross(t.p[(k + 1) % 3] - t.p[k], p.middle - t.p[k]), n) < 0.0) return;
    }
    p.nearest = distance;
  }

  const world_geometry& w_;
  std::vector<point> points_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> grid_;
};

// The lowest polygon that faces up, per square of 8 m.
void measure_ground(const world_geometry& w, std::vector<row>& out) {
  std::unordered_map<std::uint64_t, double> lowest;
  for (std::size_t i = 0; i < w.kinds.size(); ++i) {
    if (w.kinds[i].absent) continue;
    const triangle t = triangle_of(w, i);
    const glm::dvec3 n = t.normal();
    if (n.y < 0.7 * glm::length(n) || t.longest() < 1.0) continue;
    const glm::dvec3 middle = (t.p[0] + t.p[1] + t.p[2]) / 3.0;
    const auto square =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(middle.x / 8.0))) << 32 ^
        (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(middle.z / 8.0))) & 0xFFFFFFFF);
    const auto [it, is_new] = lowest.try_emplace(square, middle.y);
    if (!is_new) it->second = std::min(it->second, middle.y);
  }
  std::vector<double> heights;
  for (const auto& [square, y] : lowest) heights.push_back(y);
  if (heights.empty()) return;
  std::sort(heights.begin(), heights.end());
  const auto at = [&heights](double q) {
    return heights[static_cast<std::size_t>(q * static_cast<double>(heights.size() - 1))];
  };
  const glm::vec3 size = w.max - w.min;
  out.push_back({"extent in x, m", size.x, false});
  out.push_back({"extent in z, m", size.z, false});
  out.push_back({"height of everything, m", size.y, false});
  out.push_back({"ground, 5 % lowest to 5 % highest, m", at(0.95) - at(0.05), false});
  out.push_back({"ground, 25 % to 75 %, m", at(0.75) - at(0.25), false});
}

std::vector<row> measure(const scene& s, std::size_t samples) {
  const world_geometry w = flatten(s);
  std::vector<row> out;
  out.push_back({"polygons", static_cast<double>(s.polygon_count), false});
  out.push_back({"draws", static_cast<double>(s.draws.size()), false});
  measure_shapes(w, out);
  measure_pieces(w, out);
  neighbor_search(w, samples).print(out);
  measure_ground(w, out);
  return out;
}

std::string text_of(const row& r) {
  std::array<char, 64> text{};
  if (r.is_share) {
    std::snprintf(text.data(), text.size(), "%.1f %%", 100.0 * r.value);
  } else if (r.value > 5000.0) {
    std::snprintf(text.data(), text.size(), "%.0f", r.value);
  } else {
    std::snprintf(text.data(), text.size(), "%.1f", r.value);
  }
  return text.data();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Prints what scenes are made of: how long, thin, small, tilted and close together polygons are",
               "bench_city");
  std::vector<std::string> paths;
  std::string json_file;
  bool quick = false;
  app.add_option("scenes", paths, "scenes, .glb or .gltf")->required();
  app.add_flag("--quick", quick, "a tenth of the samples for what lies close together");
  app.add_option("--json-file", json_file, "write the figures there");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    std::vector<std::vector<row>> columns;
    nlohmann::json document = nlohmann::json::object();  // scene: [name, value, is a share]...
    std::string head = "| share of the polygons |", rule = "|---|";
    for (const std::string& path : paths) {
      const scene s = sightcell::scene::load_gltf(path);
      columns.push_back(measure(s, quick ? 2000 : 20000));
      head += " " + s.name + " |";
      rule += "---|";
      for (const row& r : columns.back()) document[s.name].push_back({r.name, r.value, r.is_share});
    }
    std::cout << head << '\n' << rule << '\n';
    for (std::size_t i = 0; i < columns.front().size(); ++i) {
      std::cout << "| " << columns.front()[i].name << " |";
      for (const auto& column : columns) std::cout << ' ' << (i < column.size() ? text_of(column[i]) : "") << " |";
      std::cout << '\n';
    }
    if (!json_file.empty()) {
      std::ofstream stream(json_file);
      stream << document.dump(1) << '\n';
      if (!stream) throw std::runtime_error(json_file + ": cannot be written");
    }
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return 0;
}
