#include "search/volume_search.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tuple>

#include "cell_set/point_order.h"
#include "search/aim.h"
#include "sightcell/base/random.h"
#include "trace/direction_code.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t viewpoint_count = 256;  // testing a viewpoint costs about as much as thirty rays from it
constexpr std::uint64_t most_viewpoint_tests = 16384;
constexpr int rays_in_all_directions = 64;     // per viewpoint
constexpr std::size_t wave = 2048;             // lines that are cast with one state of the set
constexpr std::size_t stretch = 64;            // lines of a wave per thread
constexpr std::uint8_t not_a_neighbor = 0xFF;  // value of tries_: no neighbor is a member
// Limits the rays toward a volume with a high priority that is not visible, such as one below a visible floor.
constexpr std::uint8_t most_tries = 254;

std::array<volume_place, 6> neighbors_of(const volume_place& at) {
  return {{{at.x - 1, at.y, at.z},
           {at.x + 1, at.y, at.z},
           {at.x, at.y - 1, at.z},
           {at.x, at.y + 1, at.z},
           {at.x, at.y, at.z - 1},
           {at.x, at.y, at.z + 1}}};
}

}  // namespace

volume_search::volume_search(const ray_scene& rays, const volume_grid& grid, const viewpoint_region& where,
                             const volume_search_settings& how, cell_set& set)
    : rays_(rays),
      grid_(grid),
      grown_(where.whole()),
      how_(how),
      set_(set),
      eye_of_(grid.count(), volume_grid::none),
      tries_(grid.count(), not_a_neighbor) {
  random_stream random(how.seed, how.place, purpose::volumes);
  viewpoints_ = draw_viewpoints(rays, where, how.player_radius, viewpoint_count, most_viewpoint_tests, random, spent_);
  if (viewpoints_.empty()) viewpoints_ = set.eyes();
  if (viewpoints_.empty()) return;
  for (const std::uint32_t volume : grid.touching(grown_)) set_.volumes().add(volume);
  // Eyes that found volumes in an earlier run are not stored.
  for (const std::uint32_t volume : set_.volumes().members()) join(volume, viewpoints_.front());
}

void volume_search::join(std::uint32_t volume, const glm::vec3& eye) {
  set_.volumes().add(volume);
  if (eye_of_[volume] != volume_grid::none) return;
  if (eyes_.empty() || eyes_.back() != eye) eyes_.push_back(eye);
  eye_of_[volume] = static_cast<std::uint32_t>(eyes_.size() - 1);
  for (const volume_place& place : neighbors_of(grid_.places()[volume])) {
    const std::uint32_t other = grid_.at(place);
    if (other == volume_grid::none || tries_[other] != not_a_neighbor || set_.volumes().contains(other)) continue;
    tries_[other] = 0;
    candidates_.push_back(other);
  }
}

void volume_search::add(std::span<const found_volume> found) {
  for (const found_volume& f : found) join(f.volume, f.eye);
}

// Returns the solid angle of a square face of the volume from the closest point of the cell.
double volume_search::priority_of(std::uint32_t volume) const {
  const box where = grid_.box_of(volume);
  const glm::vec3 middle = 0.5f * (where.min + where.max);
  const double distance = glm::distance(middle, glm::clamp(middle, grown_.min, grown_.max));
  const double least = 0.5 * grid_.width();
  return grid_.width() * grid_.width() / std::max(distance * distance, least * least);
}

// Rays toward the polygons of the set, because the space in front of a visible polygon is visible, and rays in random
// directions.
std::vector<volume_search::line_to_cast> volume_search::first_lines() const {
  std::vector<line_to_cast> lines;
  lines.reserve(set_.members().size() + viewpoints_.size() * rays_in_all_directions);
  random_stream random(how_.seed, how_.place, purpose::volumes, 1);
  for (const glm::vec3& eye : viewpoints_)
    for (int i = 0; i < rays_in_all_directions; ++i) lines.push_back({{eye, random.on_sphere()}});
  for (const std::uint32_t polygon : set_.members()) {
    const triangle corners = corners_of(rays_.geometry(), polygon);
    random_stream of_polygon(how_.seed, how_.place, purpose::volumes, 2, name_of(corners));
    const glm::vec3 toward = random_point(corners, of_polygon) - set_.witness(polygon);
    const float length = glm::length(toward);
    if (length > 0.0f && std::isfinite(length)) lines.push_back({{set_.witness(polygon), toward / length}});
  }
  return lines;
}

// Returns the eye that found a neighbor of a candidate.
const glm::vec3& volume_search::eye_of_neighbor(std::uint32_t volume) const {
  for (const volume_place& place : neighbors_of(grid_.places()[volume])) {
    const std::uint32_t other = grid_.at(place);
    if (other != volume_grid::none && eye_of_[other] != volume_grid::none) return eyes_[eye_of_[other]];
  }
  return viewpoints_.front();
}

// Returns one try for each neighbor of a member with enough priority: first from the eye that found its neighbor,
// then from random viewpoints.
std::vector<volume_search::line_to_cast> volume_search::next_lines(double priority) {
  std::vector<line_to_cast> lines;
  std::erase_if(candidates_, [&](std::uint32_t volume) { return set_.volumes().contains(volume); });
  std::sort(candidates_.begin(), candidates_.end());
  for (const std::uint32_t volume : candidates_) {
    std::uint8_t& tries = tries_[volume];
    if (tries == most_tries || priority_of(volume) / (tries + 1.0) < priority) continue;
    random_stream random(how_.seed, how_.place, purpose::volumes, 3 + std::uint64_t{tries}, volume);
    glm::vec3 eye = viewpoints_[random.bits() % viewpoints_.size()];
    if (tries == 0) eye = eye_of_neighbor(volume);
    ++tries;
    const box where = grid_.box_of(volume);
    const glm::vec3 toward = random.in_box(where.min, where.max) - eye;
    const float length = glm::length(toward);
    if (length > 0.0f) lines.push_back({{eye, toward / length}, 0, volume});
  }
  return lines;
}

void volume_search::cast_wave(std::span<const line_to_cast> lines) {
  std::vector<std::vector<found_volume>> found((lines.size() + stretch - 1) / stretch);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    const std::span<const line_to_cast> some =
        lines.subspan(k * stretch, std::min(stretch, lines.size() - k * stretch));
    const grid_trial trial(grid_, set_.volumes());
    std::array<sight_line, stretch> sent;
    std::vector<sight> seen(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) sent[i] = some[i].line;
    rays_.trace(std::span(sent).first(some.size()), seen);
    std::vector<passed_volume> missing;
    for (std::size_t i = 0; i < some.size(); ++i) {
      trial.lacking(sent[i], free_length(seen[i]), missing);
      drop_behind_gaps(rays_, sent[i], how_.smallest_gap, missing);
      for (const passed_volume& p : missing) found[k].push_back({p.volume, sent[i].eye});
    }
  });
  spent_ += lines.size();
  std::vector<found_volume> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  // Of several eyes that found a volume the lowest is kept.
  std::sort(all.begin(), all.end());
  for (const found_volume& f : all) join(f.volume, f.eye);
}

// Each wave has rays in all directions. Volumes that one wave found need no test in the next one, and a test for
// light leaks (rule 3) takes several rays.
void volume_search::cast(std::vector<line_to_cast> lines) {
  for (line_to_cast& one : lines) one.code = direction_code(one.line.direction);
  tbb::parallel_sort(lines.begin(), lines.end(), [](const line_to_cast& a, const line_to_cast& b) {
    if (a.line.eye != b.line.eye) return is_lower(a.line.eye, b.line.eye);
    if (a.code != b.code) return a.code < b.code;
    if (a.line.direction != b.line.direction) return is_lower(a.line.direction, b.line.direction);
    return a.target < b.target;
  });
  const std::size_t waves = (lines.size() + wave - 1) / wave;
  std::vector<line_to_cast> now;
  for (std::size_t first = 0; first < waves && !over(); ++first) {
    now.clear();
    for (std::size_t i = first; i < lines.size(); i += waves)
      if (lines[i].target == volume_grid::none || !set_.volumes().contains(lines[i].target)) now.push_back(lines[i]);
    cast_wave(now);
  }
}

void volume_search::look_for(double priority) {
  if (viewpoints_.empty()) return;
  if (!began_) cast(first_lines());
  began_ = true;
  for (;;) {
    std::vector<line_to_cast> lines = next_lines(priority);
    if (lines.empty() || over()) return;
    cast(std::move(lines));
  }
}

}  // namespace sightcell::bake
