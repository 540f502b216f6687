// Where volumes are, and which of them a line passes: told by boxes and segments, not by steps through a lattice.
#include "volumes/volume_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <vector>

#include "cells/walkable.h"
#include "errors/error_id.h"
#include "sightcell/base/error.h"
#include "sightcell/base/random.h"
#include "sightcell/format/records.h"
#include "volumes/stored_volumes.h"

namespace sightcell::bake {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

view_cell cell(const glm::vec3& min, const glm::vec3& max) {
  view_cell made;
  made.min = min, made.max = max;
  return made;
}

// What a box leaves of a line before `to`: from where to where; from above to: nothing.
std::pair<double, double> part_inside(const glm::dvec3& min, const glm::dvec3& max, const sight_line& line, double to) {
  double from = 0.0;
  for (glm::length_t i = 0; i < 3; ++i) {
    const double eye = line.eye[i], along = line.direction[i];
    if (along == 0.0) {
      if (eye < min[i] || eye >= max[i]) return {1.0, 0.0};
      continue;
    }
    const double a = (min[i] - eye) / along, b = (max[i] - eye) / along;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return {from, to};
}

struct walked {
  std::uint32_t volume;
  double distance;
};

std::vector<walked> walk(const volume_grid& grid, const sight_line& line, double to) {
  std::vector<walked> found;
  grid.for_each_passed(line, to, [&](std::uint32_t volume, double distance) {
    found.push_back({volume, distance});
    return true;
  });
  return found;
}

// By the lattice of a file that has the grid's places.
class file_volumes {
 public:
  explicit file_volumes(const volume_grid& grid) : volumes_(shape_of(grid), places_of(grid)) {}

  std::vector<walked> walk(const sight_line& line, double to) const {
    std::vector<passed_volume> passed;
    volumes_.passed(line, to, passed);
    std::vector<walked> found;
    for (const passed_volume& p : passed) found.push_back({p.volume, double{p.distance}});
    return found;
  }

 private:
  static format::lattice_shape shape_of(const volume_grid& grid) { return {grid.width(), grid.width()}; }
  static std::vector<format::lattice_place> places_of(const volume_grid& grid) {
    std::vector<format::lattice_place> places;
    for (const volume_place& p : grid.places()) places.push_back({p.x, p.y, p.z, 0});
    return places;
  }
  stored_volumes volumes_;
};

// All that the line is inside of for longer than rounding, each once, the nearest first, and nothing it is not inside
// of.
void expect_passed(const volume_grid& grid, const sight_line& line, double to, const std::vector<walked>& passed) {
  const double reach = glm::length(glm::dvec3(line.eye)) + 1000.0, least = 1e-12 * reach;
  std::set<std::uint32_t> seen;
  double before = 0.0;
  for (const walked& w : passed) {
    EXPECT_TRUE(seen.insert(w.volume).second) << "twice";
    EXPECT_GE(w.distance, before);
    before = w.distance;
  }
  for (std::uint32_t volume = 0; volume < grid.count(); ++volume) {
    const volume_place& p = grid.places()[volume];
    const glm::dvec3 min = glm::dvec3(p.x, p.y, p.z) * grid.width();
    const auto [from, end] = part_inside(min, min + grid.width(), line, to);
    if (std::abs(end - from) <= least) continue;
    EXPECT_EQ(seen.contains(volume), end > from) << from << " to " << end;
  }
  for (const walked& w : passed) {
    const volume_place& p = grid.places()[w.volume];
    const glm::dvec3 min = glm::dvec3(p.x, p.y, p.z) * grid.width();
    EXPECT_NEAR(w.distance, part_inside(min, min + grid.width(), line, to).first, 1e-6 * reach);
  }
}

void expect_both_pass(const volume_grid& grid, const sight_line& line, double to) {
  expect_passed(grid, line, to, walk(grid, line, to));
  expect_passed(grid, line, to, file_volumes(grid).walk(line, to));
}

// A few boxes with gaps between them, somewhere.
volume_grid some_grid(const glm::vec3& around, double width, random_stream& random) {
  std::vector<view_cell> cells;
  for (int i = 0; i < 6; ++i) {
    const glm::vec3 min = around + random.in_box(glm::vec3(-20.0f), glm::vec3(20.0f));
    cells.push_back(cell(min, min + random.in_box(glm::vec3(0.5f), glm::vec3(6.0f))));
  }
  return volume_grid(cells, width, 0.25);
}

TEST(volume_grid, a_line_passes_what_it_is_inside_of) {
  random_stream random(1, 2, purpose::volumes);
  for (const glm::vec3& around : {glm::vec3(0), glm::vec3(-31, -7, 55), glm::vec3(1e5f, -3e4f, -2e5f)})
    for (const double width : {0.7, 2.0, 5.0}) {
      const volume_grid grid = some_grid(around, width, random);
      ASSERT_GT(grid.count(), 10u);
      const file_volumes file(grid);
      for (int i = 0; i < 200; ++i) {
        const glm::vec3 eye = around + random.in_box(glm::vec3(-30.0f), glm::vec3(30.0f));
        const sight_line line{eye, random.on_sphere()};
        const double to = i % 3 == 0 ? infinity : 40.0 * double{random.uniform()};
        expect_passed(grid, line, to, walk(grid, line, to));
        expect_passed(grid, line, to, file.walk(line, to));
      }
    }
}

TEST(volume_grid, a_line_may_run_along_an_axis_and_begin_on_a_border) {
  const std::vector<view_cell> cells{cell({-8, 0, -8}, {8, 2, 8})};
  const volume_grid grid(cells, 2.0, 0.25);
  for (const float x : {-4.0f, 0.0f, 1.0f, 4.0f, -5.5f})
    for (const float z : {-2.0f, 0.0f, 3.25f})
      for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.0f, -1.0f}) {
          glm::vec3 direction(0);
          direction[axis] = sign;
          expect_both_pass(grid, {{x, 0.0f, z}, direction}, infinity);
          expect_both_pass(grid, {{x, 0.0f, z}, direction}, 5.0);
          expect_both_pass(grid, {{x, 2.0f, z}, glm::normalize(glm::vec3(sign, 0, sign))}, infinity);
        }
  // On a border the place above it is meant, whichever way the line goes.
  const auto passed = walk(grid, {{0, 1, 0}, {0, 0, 1}}, 1.0);
  ASSERT_EQ(passed.size(), 1u);
  EXPECT_EQ(passed[0].volume, grid.at({0, 0, 0}));
}

TEST(volume_grid, a_line_from_outside_finds_its_way_in) {
  const std::vector<view_cell> cells{cell({100, 0, 100}, {104, 2, 104})};
  const volume_grid grid(cells, 2.0, 0.25);
  random_stream random(1, 3, purpose::volumes);
  std::size_t met = 0;
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 eye = random.in_box({-50, -20, -50}, {50, 20, 50}), at = random.in_box({98, -2, 98}, {106, 3, 106});
    expect_both_pass(grid, {eye, glm::normalize(at - eye)}, infinity);
    met += walk(grid, {eye, glm::normalize(at - eye)}, infinity).size();
  }
  EXPECT_GT(met, 500u);
  EXPECT_TRUE(walk(grid, {{0, 0, 0}, {-1, 0, 0}}, infinity).empty());
  EXPECT_TRUE(walk(grid, {{0, 50, 0}, {1, 0, 0}}, infinity).empty());
}

TEST(volume_grid, a_visitor_ends_the_line) {
  const std::vector<view_cell> cells{cell({-8, 0, -8}, {8, 2, 8})};
  const volume_grid grid(cells, 2.0, 0.25);
  int calls = 0;
  grid.for_each_passed({{-7, 1, 1}, {1, 0, 0}}, infinity, [&](std::uint32_t, double) { return ++calls < 3; });
  EXPECT_EQ(calls, 3);
}

TEST(volume_grid, holds_all_of_a_figure_wherever_its_eye_may_be) {
  const std::vector<view_cell> cells{cell({-4, -2, 8}, {0, 0, 12}), cell({0, 0, 8}, {4, 2, 12})};
  random_stream random(1, 4, purpose::volumes);
  for (const double width : {0.5, 2.0, 3.0})
    for (const double margin : {0.0, 0.25, 1.0}) {
      const volume_grid grid(cells, width, margin);
      for (int i = 0; i < 2000; ++i) {
        const view_cell& in = cells[static_cast<std::size_t>(i) % 2];
        const auto by = static_cast<float>(margin);
        const glm::vec3 eye = random.in_box(in.min - by, in.max + by);
        const glm::vec3 feet = eye - glm::vec3(0, static_cast<float>(eye_height), 0);
        const glm::vec3 at = feet + random.in_box({-0.25f, 0, -0.25f}, {0.25f, 2, 0.25f});
        if (margin > 0.25 &&
            (at.x < in.min.x - by || at.x > in.max.x + by || at.z < in.min.z - by || at.z > in.max.z + by))
          continue;
        const glm::dvec3 place = glm::floor(glm::dvec3(at) / width);
        EXPECT_NE(grid.at({static_cast<int>(place.x), static_cast<int>(place.y), static_cast<int>(place.z)}),
                  volume_grid::none);
      }
    }
}

TEST(volume_grid, numbers_are_a_matter_of_places) {
  const std::vector<view_cell> cells{cell({0, 0, 0}, {4, 2, 4}), cell({4, 0, 0}, {8, 2, 4}),
                                     cell({-9, 3, 40}, {-5, 5, 44})};
  const std::vector<view_cell> turned{cells[2], cells[0], cells[1], cells[0]};
  const volume_grid one(cells, 2.0, 0.25), other(turned, 2.0, 0.25);
  EXPECT_EQ(one.places(), other.places());
  ASSERT_EQ(one.places().size(), one.count());
  for (std::uint32_t volume = 0; volume < one.count(); ++volume) {
    EXPECT_EQ(one.at(one.places()[volume]), volume);
    const box where = one.box_of(volume);
    EXPECT_EQ(where.max - where.min, glm::vec3(2));
  }
  EXPECT_EQ(one.at({1000, 0, 0}), volume_grid::none);
  EXPECT_EQ(one.at({-2, 0, 20}), one.at({-2, 0, 20}));
}

TEST(volume_grid, touching_takes_what_shares_a_point) {
  const std::vector<view_cell> cells{cell({-8, 0, -8}, {8, 2, 8})};
  const volume_grid grid(cells, 2.0, 0.25);
  const auto touched = grid.touching({{0, 0, 0}, {2, 1, 1}});
  std::set<std::uint32_t> wanted;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 0; ++y)
      for (int z = -1; z <= 0; ++z) wanted.insert(grid.at({x, y, z}));
  EXPECT_EQ(std::set<std::uint32_t>(touched.begin(), touched.end()), wanted);
  EXPECT_EQ(grid.touching({{-100, -100, -100}, {100, 100, 100}}).size(), grid.count());
  EXPECT_TRUE(grid.touching({{100, 0, 0}, {101, 1, 1}}).empty());
}

TEST(volume_grid, too_many_are_refused) {
  const auto id = [](const std::vector<view_cell>& cells, double width) {
    return test::error_id([&] { const volume_grid grid(cells, width, 0.25); });
  };
  EXPECT_EQ(id({cell({0, 0, 0}, {200, 200, 200})}, 0.25), "volumes.too-many") << "in one cell";
  EXPECT_EQ(id({cell({0, 0, 0}, {4, 2, 4}), cell({9e6f, 9e5f, 9e6f}, {9e6f + 4, 9e5f + 2, 9e6f + 4})}, 0.25),
            "volumes.too-many")
      << "too wide";
  EXPECT_EQ(id({cell({9e9f, 0, 0}, {9.1e9f, 2, 4})}, 0.25), "volumes.too-many") << "too far";
  std::vector<view_cell> many;
  for (int i = 0; i < 40; ++i)
    many.push_back(cell({200.0f * static_cast<float>(i), 0, 0}, {200.0f * static_cast<float>(i) + 99, 60, 99}));
  EXPECT_EQ(id(many, 0.7), "volumes.too-many") << "together";
  const std::vector<view_cell> none;
  EXPECT_EQ(volume_grid(none, 2.0, 0.25).count(), 0u);
  EXPECT_TRUE(walk(volume_grid(none, 2.0, 0.25), {{0, 0, 0}, {1, 0, 0}}, infinity).empty());
}

}  // namespace
}  // namespace sightcell::bake
