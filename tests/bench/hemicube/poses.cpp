#include "bench/hemicube/poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "bench/hemicube/world.h"
#include "cells/view_cell.h"
#include "cells/walkable.h"
#include "sightcell/base/error.h"
#include "trace/viewpoints.h"

namespace sightcell::bench {
namespace {

constexpr std::uint64_t tries_of_a_cell = 512;

// Onto the floor below, eye height above it; the place itself where there is none near, or no free place above it.
glm::vec3 at_eye_height(const bake::ray_scene& rays, const glm::vec3& place, float radius) {
  bake::sight below;
  rays.trace(place, {0.0f, -1.0f, 0.0f}, below);
  if (below.front == bake::no_polygon || below.distance > 4.0f) return place;
  glm::vec3 moved = place;
  moved.y += static_cast<float>(bake::eye_height) - below.distance;
  return rays.is_valid(moved, radius) ? moved : place;
}

// Poses look along headings the golden angle apart, so that any number of them is spread evenly.
bake::pose looking(const glm::vec3& eye, std::size_t number, bool above) {
  const double heading = static_cast<double>(number) * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const bool down = above && number % 2 == 1;
  const bool turned = (above ? number / 2 : number) % 2 == 1;
  const double pitch = down ? -std::numbers::pi / 4.0 : 0.0, roll = turned ? std::numbers::pi / 4.0 : 0.0;
  const glm::dvec3 level{std::sin(heading), 0.0, -std::cos(heading)}, up{0.0, 1.0, 0.0};
  const glm::dvec3 forward = std::cos(pitch) * level + std::sin(pitch) * up;
  const glm::dvec3 right = glm::normalize(glm::cross(forward, up)), over = glm::cross(right, forward);
  const glm::dvec3 rolled = std::cos(roll) * right + std::sin(roll) * over;
  return {eye, glm::vec3(forward), glm::vec3(rolled), glm::vec3(glm::cross(rolled, forward))};
}

json text_of(const glm::vec3& v) {
  return json::array({v.x, v.y, v.z});
}

glm::vec3 vector_of(const json& v) {
  return {v.at(0).get<float>(), v.at(1).get<float>(), v.at(2).get<float>()};
}

}  // namespace

float metres_of(const std::string& height) {
  return height == "street" ? 0.0f : std::stof(height);
}

json make_poses(const json& job) {
  const world w(job.at("scene").get<std::string>());
  const bake::ray_scene rays(w.geometry, false);
  bake::settings how;
  how.seed = job.at("seed").get<std::uint64_t>();
  if (const auto cells = job.at("cells").get<std::string>(); !cells.empty()) how.cells_file = cells;
  const bake::cell_list list = bake::make_cells(w.geometry, how);
  const auto wanted = job.at("poses").get<std::size_t>();

  std::vector<glm::vec3> places;
  const std::size_t cells = list.cells.size();
  for (std::size_t i = 0; i < wanted; ++i) {
    // A cell inside a wall has no free point: the next one along the list takes its place.
    for (std::size_t step = 0; step < cells; ++step) {
      const bake::view_cell& cell = list.cells[(i * cells / wanted + step) % cells];
      bake::random_stream random(how.seed, cell.place, bake::purpose::viewpoints, 0, i);
      std::uint64_t tries = 0;
      const auto free =
          bake::draw_viewpoints(rays, {cell.min, cell.max}, how.player_radius, 1, tries_of_a_cell, random, tries);
      if (free.empty()) continue;
      places.push_back(at_eye_height(rays, free.front(), how.player_radius));
      break;
    }
  }
  if (places.empty())
    throw error(error_kind::bad_input, "bench.no-place", w.name, "has no free place to look from",
                "name another scene");
  json answer{{"cells", list.how}, {"heights", json::object()}};
  for (const char* height : all_heights) {
    json poses = json::array();
    const float above = metres_of(height);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bake::pose p = looking(places[i] + glm::vec3{0.0f, above, 0.0f}, i, above > 0.0f);
      poses.push_back({{"eye", text_of(p.eye)},
                       {"forward", text_of(p.forward)},
                       {"right", text_of(p.right)},
                       {"up", text_of(p.up)},
                       {"free", rays.is_valid(p.eye, how.player_radius)}});
    }
    answer["heights"][height] = std::move(poses);
  }
  return answer;
}

std::vector<bake::pose> read_poses(const json& list) {
  std::vector<bake::pose> poses;
  for (const json& p : list)
    poses.push_back(
        {vector_of(p.at("eye")), vector_of(p.at("forward")), vector_of(p.at("right")), vector_of(p.at("up"))});
  return poses;
}

}  // namespace sightcell::bench
