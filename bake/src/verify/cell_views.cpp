#include "sightcell/bake/cell_views.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <glm/vec3.hpp>
#include <optional>

#include "cells/floors.h"
#include "sightcell/base/random.h"
#include "trace/viewpoints.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t most_tries = 20'000;  // points per cell; regions have more than one valid point in 2,000
constexpr int level_directions = 16;
constexpr std::uint64_t view_round = 1;      // verification rays are round 0
constexpr float target_in_the_open = 10.0f;  // meters

// Distance to the first occluder.
float free_distance(const ray_scene& rays, const glm::vec3& eye, const glm::vec3& direction, sight& found) {
  rays.trace(eye, direction, found);
  return found.front == no_polygon ? std::numeric_limits<float>::infinity() : found.distance;
}

// Cosine and sine of the first quarter turn; the rest follows by symmetry, so that every machine has the same bits.
glm::vec3 level_direction(int number) {
  constexpr std::array<float, 5> cosines{1.0f, 0.92387953f, 0.70710678f, 0.38268343f, 0.0f};
  const auto part = static_cast<std::size_t>(number % 4);
  const float x = cosines[part], z = cosines[4 - part];
  switch (number / 4) {
    case 0:
      return {x, 0.0f, z};
    case 1:
      return {-z, 0.0f, x};
    case 2:
      return {-x, 0.0f, -z};
    default:
      return {z, 0.0f, -x};
  }
}

cell_view view_from(const ray_scene& rays, std::uint32_t cell, const glm::vec3& eye) {
  sight found;
  cell_view view{.cell = cell, .eye = {eye.x, eye.y, eye.z}};
  view.above = free_distance(rays, eye, {0.0f, 1.0f, 0.0f}, found);
  view.below = free_distance(rays, eye, {0.0f, -1.0f, 0.0f}, found);
  glm::vec3 target = eye + target_in_the_open * level_direction(0);
  float farthest = 0.0f;
  for (int i = 0; i < level_directions; ++i) {
    const glm::vec3 direction = level_direction(i);
    const float distance = free_distance(rays, eye, direction, found);
    if (!std::isfinite(distance) || distance <= farthest) continue;
    farthest = distance;
    target = eye + distance * direction;
  }
  view.target = {target.x, target.y, target.z};
  return view;
}

}  // namespace

std::vector<cell_view> find_cell_views(const scene::scene& s, const scene::scene* cells_from,
                                       std::span<const std::byte> file, const std::string& name,
                                       std::span<const std::uint32_t> cells, std::uint64_t seed) {
  verified_file opened(s, cells_from, file, name);
  opened.build_rays();
  std::vector<std::optional<cell_view>> found(cells.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
    random_stream random(seed, cells[i], purpose::verify, view_round);
    std::uint64_t tries = 0;
    const std::vector<glm::vec3> eyes = draw_viewpoints(opened.rays(), opened.region(cells[i]),
                                                        opened.rules().player_radius, 1, most_tries, random, tries);
    if (!eyes.empty()) found[i] = view_from(opened.rays(), cells[i], eyes.front());
  });
  std::vector<cell_view> views;
  for (const std::optional<cell_view>& one : found)
    if (one) views.push_back(*one);
  return views;
}

std::vector<cell_floor> floors_of_cells(std::span<const cell_box> cells, bool over_floors) {
  std::vector<view_cell> boxes(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& [min, max] = std::pair(cells[i].min, cells[i].max);
    boxes[i].min = {min[0], min[1], min[2]};
    boxes[i].max = {max[0], max[1], max[2]};
    boxes[i].floor = static_cast<double>(min[1]);
    boxes[i].floor_area = over_floors ? 1.0 : 0.0;
  }
  return find_floors(boxes, most_floors);
}

}  // namespace sightcell::bake
