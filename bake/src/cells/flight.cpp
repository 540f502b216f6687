#include "cells/flight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <set>

#include "cells/path_file.h"
#include "sightcell/base/error.h"
#include "trace/line_box.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t cell_limit = 1'000'000;  // as for --cells-grid
constexpr double test_limit = 1e8;             // of cells that may be near a path: some ten seconds

[[noreturn]] void refuse_many(const char* option, double cells) {
  throw error(error_kind::wrong_use, "cells.too-many", option,
              fmt::format("{:.0f} cells, more than {}", cells, cell_limit), "use a larger --cell-size, or less space");
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

class flight_finder {
 public:
  flight_finder(const scene::world_geometry& geometry, const lattice& on, const settings& how)
      : min_(geometry.min), max_(geometry.max), on_(on), radius_(how.path_radius) {}

  void add_box(const std::array<float, 6>& box);
  void add_path(const camera_path& path);
  flight_cells take();

 private:
  void add_piece(const glm::dvec3& from, const glm::dvec3& to);

  const glm::dvec3 min_, max_;
  const lattice on_;
  const float radius_;
  std::set<lattice_position> found_;
  double tests_ = 0.0;
  std::size_t boxes_ = 0, paths_ = 0;
  flight_cells out_;
};

void flight_finder::add_box(const std::array<float, 6>& box) {
  const glm::dvec3 low(box[0], box[1], box[2]), high(box[3], box[4], box[5]);
  const lattice_range range = on_.overlapping(low, high);
  if (range.count() > static_cast<double>(cell_limit)) refuse_many("--fly", range.count());
  for (std::int64_t z = range.first.z; z <= range.last.z; ++z)
    for (std::int64_t y = range.first.y; y <= range.last.y; ++y)
      for (std::int64_t x = range.first.x; x <= range.last.x; ++x) found_.insert({.z = z, .y = y, .x = x});
  if (found_.size() > cell_limit) refuse_many("--fly", static_cast<double>(found_.size()));
  if (glm::any(glm::greaterThan(low, max_)) || glm::any(glm::lessThan(high, min_)))
    out_.warnings.push_back(fmt::format(
        "the box {} of --fly is outside of the scene, which is from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})",
        fmt::join(box, ","), min_.x, min_.y, min_.z, max_.x, max_.y, max_.z));
  ++boxes_;
}

// Adds the cells whose grown boxes meet a piece of a path that is at most as long as a cell is wide.
void flight_finder::add_piece(const glm::dvec3& from, const glm::dvec3& to) {
  const auto radius = static_cast<double>(radius_);
  const lattice_range range = on_.overlapping(glm::min(from, to) - radius, glm::max(from, to) + radius);
  tests_ += range.count();
  if (tests_ > test_limit) refuse_many("--path", tests_);
  const glm::vec3 start(from), direction(to - from);
  for (std::int64_t z = range.first.z; z <= range.last.z; ++z)
    for (std::int64_t y = range.first.y; y <= range.last.y; ++y)
      for (std::int64_t x = range.first.x; x <= range.last.x; ++x) {
        const lattice_position at{.z = z, .y = y, .x = x};
        const view_cell cell = on_.cell(at);
        float first = 0.0f, last = 1.0f;
        if (clip_line(cell.min - radius_, cell.max + radius_, start, direction, first, last)) found_.insert(at);
      }
}

void flight_finder::add_path(const camera_path& path) {
  bool inside = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto point = [&](std::size_t at) { return glm::dvec3(path[at][0], path[at][1], path[at][2]); };
    const glm::dvec3 from = point(i == 0 ? 0 : i - 1), to = point(i);
    inside |= glm::all(glm::greaterThanEqual(to, min_)) && glm::all(glm::lessThanEqual(to, max_));
    // In pieces, because the box around a long diagonal has very many cells.
    const double pieces = std::max(std::ceil(glm::distance(from, to) / on_.width()), 1.0);
    if (pieces > static_cast<double>(cell_limit)) refuse_many("--path", pieces);
    for (double piece = 0.0; piece < pieces; ++piece)
      add_piece(glm::mix(from, to, piece / pieces), glm::mix(from, to, (piece + 1.0) / pieces));
    if (found_.size() > cell_limit) refuse_many("--path", static_cast<double>(found_.size()));
  }
  if (!inside) out_.warnings.push_back(fmt::format("path {} has no point in the bounding box of the scene", paths_));
  ++paths_;
}

flight_cells flight_finder::take() {
  out_.cells.assign(found_.begin(), found_.end());
  if (boxes_ > 0) out_.how = fmt::format("in {} of --fly", counted(boxes_, "box", "boxes"));
  if (paths_ > 0)
    out_.how += fmt::format("{}within {:g} m of {}", boxes_ > 0 ? ", " : "", radius_, counted(paths_, "path", "paths"));
  return std::move(out_);
}

}  // namespace

flight_cells find_flight_cells(const scene::world_geometry& geometry, const lattice& on, const settings& how) {
  flight_finder finder(geometry, on, how);
  for (const std::array<float, 6>& box : how.fly) finder.add_box(box);
  if (how.path_file)
    for (const camera_path& path : read_paths(*how.path_file)) finder.add_path(path);
  for (const camera_path& path : how.paths) finder.add_path(path);
  return finder.take();
}

}  // namespace sightcell::bake
