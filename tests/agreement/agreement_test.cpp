// All sources see what rays see, but for pixels with an edge through their center and for surfaces in the same place.
// On own scenes and in small; tests/bench/bench_agreement does it in large.
#include "agreement/agreement.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "cells/view_cell.h"
#include "city.h"
#include "glb_writer.h"
#include "hemicube/rays/rays_source.h"
#include "trace/viewpoints.h"
#include "unit/bake/hemicube/all_sources.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using namespace sightcell::test;

constexpr std::uint32_t resolution = 512;

struct tried_scene {
  explicit tried_scene(scene::world_geometry made)
      : geometry(std::make_unique<scene::world_geometry>(std::move(made))),
        rays(std::make_unique<bake::ray_scene>(*geometry, false)) {}

  std::unique_ptr<scene::world_geometry> geometry;  // stays where it is: the rays look there
  std::unique_ptr<bake::ray_scene> rays;
  std::vector<bake::pose> poses;
};

// Turned in all ways, looking mostly along the horizon.
bake::pose turned(const glm::vec3& eye, std::mt19937& random) {
  const auto number = [&] { return static_cast<float>(random() >> 8) / 16777216.0f; };
  const float heading = 6.2831853f * number(), slope = number() - 0.5f;
  bake::pose p;
  p.eye = eye;
  p.forward = glm::normalize(glm::vec3(std::cos(heading), slope, std::sin(heading)));
  p.right = glm::normalize(glm::cross(p.forward, glm::vec3(0.6f * (number() - 0.5f), 1, 0.6f * (number() - 0.5f))));
  p.up = glm::cross(p.right, p.forward);
  return p;
}

// A town from its streets: MASK fences, panes, things back to back.
tried_scene town() {
  const auto path =
      std::filesystem::temp_directory_path() / ("sightcell-agreement-" + std::to_string(getpid()) + ".glb");
  sightcell::city::write_glb(sightcell::city::make_city(20000, 3), path, false);
  tried_scene s(scene::flatten(scene::load_gltf(path)));
  std::filesystem::remove(path);
  const bake::cell_list cells = bake::make_cells(*s.geometry, {});
  std::mt19937 random(5);
  for (std::size_t i = 0; s.poses.size() < 6 && i < 600; ++i) {
    const bake::view_cell& cell = cells.cells[i * 101 % cells.cells.size()];
    bake::random_stream places(1, cell.place, bake::purpose::viewpoints);
    std::uint64_t tries = 0;
    const auto free = bake::draw_viewpoints(*s.rays, {cell.min, cell.max}, 0.05f, 1, 64, places, tries);
    if (!free.empty()) s.poses.push_back(turned(free.front(), random));
  }
  return s;
}

// Polygons of all kinds and sizes at random, cutting into each other.
tried_scene heap() {
  tried_scene s(scene::flatten(cloud().finished()));
  std::mt19937 random(6);
  for (int i = 0; i < 6; ++i) s.poses.push_back(turned({0.1f * static_cast<float>(i), 0, 0}, random));
  return s;
}

// Far from the origin, where coordinates have few bits left, with huge and tiny polygons.
tried_scene far_away() {
  tiny_scene t;
  const glm::vec3 at{30000, 200, -20000};
  std::mt19937 random(7);
  const auto number = [&] { return static_cast<float>(random() >> 8) / 16777216.0f - 0.5f; };
  t.quad(at + glm::vec3(-5000, -2, -5000), at + glm::vec3(-5000, -2, 5000), at + glm::vec3(5000, -2, 5000),
         at + glm::vec3(5000, -2, -5000));
  for (int i = 0; i < 300; ++i) {
    const float away = std::pow(10.0f, 0.5f + 2.0f * (number() + 0.5f));
    const float z = away * number() * 4.0f, x = away * number() * 4.0f;  // arguments have no order
    const glm::vec3 low = at + glm::vec3(x, -2.0f, z);
    if (glm::distance(low, at) < 4.0f) continue;
    t.closed_box(low, low + glm::vec3(1, 0.2f + number() + 0.5f, 1) * (0.1f * away));
  }
  tried_scene s(scene::flatten(t.finished()));
  for (int i = 0; i < 6; ++i) s.poses.push_back(turned(at, random));
  return s;
}

const tried_scene& scene_called(const std::string& name) {
  static std::map<std::string, tried_scene> made;
  auto at = made.find(name);
  if (at == made.end()) at = made.emplace(name, name == "town" ? town() : name == "heap" ? heap() : far_away()).first;
  return at->second;
}

class agreement_test : public source_test {
 protected:
  static agreement of(const tested_source& which, const tried_scene& s) {
    const float far_plane = glm::distance(s.geometry->min, s.geometry->max);
    const auto rays = bake::make_rays_source(*s.rays, {.resolution = resolution, .far_plane = far_plane});
    const auto tested = source(which, *s.geometry, resolution, far_plane);
    agreement sum;
    std::vector<odd_pixel> odd;
    bake::hemicube_image a, b;
    for (const bake::pose& from : s.poses) {
      rays->render_image(from, a);
      tested->render_image(from, b);
      sum.add(compare(*s.rays, from, a, b, odd));
    }
    for (std::size_t i = 0; i < odd.size() && i < 5; ++i)
      ADD_FAILURE() << "pixel " << odd[i].pixel << ": rays see " << odd[i].of_rays << " at " << odd[i].depth_of_rays
                    << " m, the source " << odd[i].of_source << " at " << odd[i].depth_of_source << " m";
    EXPECT_EQ(sum.pixels, s.poses.size() * 3 * resolution * resolution);
    return sum;
  }
};

// The judge itself: one pixel of each kind, put into an image that agrees.
TEST(agreement_judge, tells_why_a_pixel_differs) {
  tiny_scene t;
  const auto wall = t.wall_x(5, -1, 20), twin = t.wall_x(5.0001f, -1, 20);  // 0.1 mm apart: the same place
  const auto side = t.quad({3, -1, 0}, {3, -1, 1}, {3, 1, 1}, {3, 1, 0});
  const scene::world_geometry geometry = scene::flatten(t.finished());
  const bake::ray_scene rays(geometry, false);
  bake::pose from = along_x;
  from.eye.z = -0.505f * 6.0f / 1024.0f;  // the edge at z = 0 runs 1/200 pixel beside the centers of column 512
  bake::hemicube_image truth;
  bake::make_rays_source(rays, {.resolution = 1024, .far_plane = 100})->render_image(from, truth);
  const auto judge = [&](std::uint32_t x, std::uint32_t y, std::uint32_t id, float inverse_depth_by = 1.0f) {
    bake::hemicube_image image = truth;
    const std::size_t pixel = y * 3072 + x;
    image.ids[pixel] = id;
    image.inverse_depths[pixel] *= inverse_depth_by;
    std::vector<odd_pixel> odd;
    const agreement found = compare(rays, from, truth, image, odd);
    EXPECT_EQ(found.pixels, 3u * 1024u * 1024u);
    EXPECT_EQ(found.elsewhere(), odd.size());
    return found;
  };
  const std::uint32_t x = 100, y = 500;
  ASSERT_TRUE(truth.ids[y * 3072 + x] == wall || truth.ids[y * 3072 + x] == wall + 1);
  EXPECT_EQ(judge(x, y, truth.ids[y * 3072 + x]).different, 0u);
  EXPECT_EQ(judge(x, y, truth.ids[y * 3072 + x] - wall + twin).coincident, 1u);
  EXPECT_EQ(judge(x, y, side).elsewhere(), 1u);
  EXPECT_EQ(judge(x, y, scene::no_index).elsewhere(), 1u);
  EXPECT_EQ(judge(x, y, truth.ids[y * 3072 + x], 1.002f).depths, 1u);
  const std::uint32_t beside = truth.ids[y * 3072 + 513];
  ASSERT_TRUE(beside == side || beside == side + 1);
  ASSERT_LT(truth.ids[y * 3072 + 512], side);
  EXPECT_EQ(judge(512, y, beside).at_edge, 1u);
  EXPECT_EQ(judge(511, y, beside).elsewhere(), 1u) << "a whole pixel away";
}

// Shares are of pixels that differ and do not see the same place. They fall with the resolution: edges per pixel.
void expect_agreement(const agreement& found, const tested_source& which) {
  const double limit = which.needs_device ? 3e-4 : 1e-5;  // OpenGL may snap corners to 1/256 pixel
  EXPECT_LE(found.share(), limit) << found.wrong() << " pixels";
  EXPECT_EQ(found.elsewhere(), 0u) << "pixels differ without an edge beside their center";
  EXPECT_LE(static_cast<double>(found.depths), 1e-5 * static_cast<double>(found.pixels));
}

TEST_P(agreement_test, in_the_streets_of_a_town) {
  ASSERT_EQ(scene_called("town").poses.size(), 6u);
  expect_agreement(of(GetParam(), scene_called("town")), GetParam());
}

TEST_P(agreement_test, in_a_heap_of_polygons) {
  expect_agreement(of(GetParam(), scene_called("heap")), GetParam());
}

TEST_P(agreement_test, far_from_the_origin) {
  expect_agreement(of(GetParam(), scene_called("far away")), GetParam());
}

SIGHTCELL_TEST_ALL_SOURCES(agreement_test);

}  // namespace
