#pragma once
// All hemicube sources, for tests that ask the same of each.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

struct tested_source {
  std::string name;
  bool needs_device;  // OpenGL
  // The context is null where none is needed.
  std::function<std::unique_ptr<bake::hemicube_source>(const picture::gl_context*, const scene::world_geometry&,
                                                       std::uint32_t resolution, float far_plane)>
      make;
};
inline void PrintTo(const tested_source& source, std::ostream* out) {
  *out << source.name;
}

const std::vector<tested_source>& all_sources();
const tested_source& source_called(const std::string& name);

constexpr std::uint32_t source_test_size = 64;

// Looks from the origin along +x: walls of tiny_scene::wall_x stand across the view.
inline const bake::pose along_x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
// Turned a little, so that no edge runs through pixel centers.
bake::pose turned_along_x();

// A few thousand random polygons of all kinds around the origin.
tiny_scene cloud();

std::uint32_t pixels_of(const bake::hemicube_view& view, std::uint32_t id);
bool sees(const bake::hemicube_view& view, std::uint32_t id);
std::uint64_t all_pixels(const bake::hemicube_view& view);
// A wall_x is two polygons; both or none must be seen.
bool sees_wall(const bake::hemicube_view& view, std::uint32_t first);

// A test of one source. One context for all tests of a program: making one takes longer than a test.
class source_test : public ::testing::TestWithParam<tested_source> {
 protected:
  void SetUp() override;  // skips where the device is not there

  static std::unique_ptr<bake::hemicube_source> source(const tested_source& which, const scene::world_geometry& world,
                                                       std::uint32_t resolution = source_test_size,
                                                       float far_plane = 100.0f);
  std::unique_ptr<bake::hemicube_source> source(const scene::world_geometry& world,
                                                std::uint32_t resolution = source_test_size, float far_plane = 100.0f) {
    return source(GetParam(), world, resolution, far_plane);
  }
  // What one hemicube sees, through the source under test.
  bake::hemicube_view look_at(tiny_scene& s, const bake::pose& from = along_x);
};

}  // namespace sightcell::test

#define SIGHTCELL_TEST_ALL_SOURCES(suite)                                                  \
  INSTANTIATE_TEST_SUITE_P(of, suite, ::testing::ValuesIn(sightcell::test::all_sources()), \
                           [](const auto& tested) { return tested.param.name; })
