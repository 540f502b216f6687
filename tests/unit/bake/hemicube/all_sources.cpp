#include "unit/bake/hemicube/all_sources.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>
#include <stdexcept>

#include "hemicube/cpu/cpu_source.h"
#include "hemicube/gpu/gpu_source.h"
#include "hemicube/rays/rays_source.h"
#include "sightcell/base/error.h"

namespace sightcell::test {
namespace {

using look = tiny_scene::look;

std::function<std::unique_ptr<bake::hemicube_source>(const picture::gl_context*, const scene::world_geometry&,
                                                     std::uint32_t, float)>
gpu(bake::gather how) {
  return [how](const picture::gl_context* context, const scene::world_geometry& world, std::uint32_t resolution,
               float far_plane) {
    return bake::make_gpu_source(*context, world, {resolution, far_plane, how});
  };
}

struct shared_context {
  std::unique_ptr<picture::gl_context> made;
  std::string why_not;
};

// Never destroyed: programs end without asking a driver that may be unloaded by then.
const shared_context& the_context() {
  static const shared_context* const shared = [] {
    auto* made = new shared_context;
    try {
      made->made = std::make_unique<picture::gl_context>(true);
    } catch (const error& e) {
      made->why_not = e.what();
    }
    return made;
  }();
  return *shared;
}

}  // namespace

const std::vector<tested_source>& all_sources() {
  using context = const picture::gl_context*;
  using world = const scene::world_geometry&;
  static const std::vector<tested_source> sources{
      {"read_back", true, gpu(bake::gather::read_back)},
      {"compute", true, gpu(bake::gather::compute)},
      {"cpu", false,
       [](context, world w, std::uint32_t size, float far) {
         return bake::make_cpu_source(w, {size, far});
       }},
      {"rays", false,
       [](context, world w, std::uint32_t size, float far) {
         return bake::make_rays_source(w, {size, far});
       }},
      {"widest_rays", false,
       [](context, world w, std::uint32_t size, float far) {
         return bake::make_rays_source(w, {size, far, true});
       }},
  };
  return sources;
}

const tested_source& source_called(const std::string& name) {
  for (const tested_source& s : all_sources()) {
    if (s.name == name) return s;
  }
  throw std::logic_error("no source is called " + name);
}

bake::pose turned_along_x() {
  bake::pose turned = along_x;
  turned.forward = glm::normalize(glm::vec3(1, 0.03f, 0.07f));
  turned.right = glm::normalize(glm::cross(turned.forward, glm::vec3(0, 1, 0.05f)));
  turned.up = glm::cross(turned.right, turned.forward);
  return turned;
}

tiny_scene cloud() {
  tiny_scene s;
  std::mt19937 engine(7);
  const auto number = [&] { return 20.0f * (static_cast<float>(engine() >> 8) / 16777216.0f - 0.5f); };
  for (int i = 0; i < 6000; ++i) {
    const look how{static_cast<scene::alpha_mode>(i % 7 < 5 ? 0 : i % 7 - 4), i % 3 == 0};
    const glm::vec3 center(number(), number(), number());
    if (glm::length(center) < 2.0f) continue;
    const auto corner = [&] { return center + 0.05f * glm::vec3(number(), number(), number()); };
    const glm::vec3 a = corner(), b = corner(), c = corner();
    s.triangle(a, b, c, how);
  }
  return s;
}

std::uint32_t pixels_of(const bake::hemicube_view& view, std::uint32_t id) {
  for (const bake::seen_polygon& p : view.seen) {
    if (p.id == id) return p.pixels;
  }
  return 0;
}

bool sees(const bake::hemicube_view& view, std::uint32_t id) {
  return pixels_of(view, id) > 0;
}

std::uint64_t all_pixels(const bake::hemicube_view& view) {
  std::uint64_t sum = 0;
  for (const bake::seen_polygon& p : view.seen) sum += p.pixels;
  return sum;
}

bool sees_wall(const bake::hemicube_view& view, std::uint32_t first) {
  EXPECT_EQ(sees(view, first), sees(view, first + 1));
  return sees(view, first);
}

void source_test::SetUp() {
  if (GetParam().needs_device && !the_context().made) GTEST_SKIP() << the_context().why_not;
  if (GetParam().needs_device) RecordProperty("renderer", the_context().made->renderer());  // for tests/gl_drivers
}

std::unique_ptr<bake::hemicube_source> source_test::source(const tested_source& which,
                                                           const scene::world_geometry& world, std::uint32_t resolution,
                                                           float far_plane) {
  return which.make(which.needs_device ? the_context().made.get() : nullptr, world, resolution, far_plane);
}

bake::hemicube_view source_test::look_at(tiny_scene& s, const bake::pose& from) {
  const scene::world_geometry world = scene::flatten(s.finished());
  bake::hemicube_view view;
  source(world)->render(from, view);
  return view;
}

}  // namespace sightcell::test
