#include "hemicube/gpu/gpu_culling.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

#include "unit/bake/hemicube/gpu/gpu_scene.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::expect_same_view;
using sightcell::test::rooms;

class gpu_culling_test : public sightcell::test::gpu_test {
 protected:
  static std::unique_ptr<bake::hemicube_source> source(const scene::world_geometry& world, bake::culling how,
                                                       std::uint32_t resolution,
                                                       std::uint32_t most_triangles = 16'000'000) {
    return bake::make_gpu_source(*context_, world,
                                 {.resolution = resolution,
                                  .far_plane = 100.0f,
                                  .how = bake::gather::read_back,
                                  .hide = how,
                                  .most_triangles = most_triangles});
  }
  void SetUp() override {
    gpu_test::SetUp();
    if (!IsSkipped() && !bake::can_cull_on_device()) GTEST_SKIP() << "the device has no GL_ARB_indirect_parameters";
  }
  // Triangles that the device is given while source renders.
  static std::uint64_t drawn_triangles(bake::hemicube_source& source, const bake::pose& from) {
    GLuint query = 0;
    GLuint64 count = 0;
    bake::hemicube_view view;
    glCreateQueries(GL_PRIMITIVES_GENERATED, 1, &query);
    glBeginQuery(GL_PRIMITIVES_GENERATED, query);
    source.render(from, view);
    glEndQuery(GL_PRIMITIVES_GENERATED);
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &count);
    glDeleteQueries(1, &query);
    return count;
  }
};

std::size_t count_of(const bake::hemicube_image& image, std::uint32_t id) {
  return static_cast<std::size_t>(std::count(image.ids.begin(), image.ids.end(), id));
}

void expect_same_image(const bake::hemicube_image& a, const bake::hemicube_image& b, const std::string& what) {
  ASSERT_EQ(a.ids.size(), b.ids.size());
  std::size_t ids = 0, depths = 0;
  for (std::size_t i = 0; i < a.ids.size(); ++i) {
    ids += a.ids[i] != b.ids[i] ? 1u : 0u;
    depths += a.inverse_depths[i] != b.inverse_depths[i] ? 1u : 0u;
  }
  EXPECT_EQ(ids, 0u) << what << ": pixels with another id";
  EXPECT_EQ(depths, 0u) << what << ": pixels with another depth";
}

// What was drawn before decides what the first pass draws, and must not show.
TEST_F(gpu_culling_test, every_way_shows_what_a_plain_draw_of_everything_shows) {
  const scene::world_geometry world = rooms().world();
  const std::vector<bake::pose> walk = rooms::walk(24);
  for (const std::uint32_t resolution : {16u, 50u, 128u}) {  // 50: faces that are no multiple of a block
    const auto plain = source(world, bake::culling::none, resolution);
    const auto frustum = source(world, bake::culling::frustum, resolution);
    const auto occlusion = source(world, bake::culling::occlusion, resolution);
    bake::hemicube_image expected, image;
    bake::hemicube_view expected_view, view;
    for (std::size_t i = 0; i < walk.size(); ++i) {
      const std::string what = "resolution " + std::to_string(resolution) + ", pose " + std::to_string(i);
      plain->render_image(walk[i], expected);
      plain->render(walk[i], expected_view);
      EXPECT_LT(count_of(expected, scene::no_index), expected.ids.size());
      for (const auto& [tested, name] :
           {std::pair{frustum.get(), "frustum, "}, std::pair{occlusion.get(), "occlusion, "}}) {
        tested->render_image(walk[i], image);
        expect_same_image(expected, image, name + what);
        tested->render(walk[i], view);
        expect_same_view(expected_view, view, name + what);
      }
    }
  }
}

// Of polygons in the same place the one in the last cluster is kept, whichever pass drew it.
TEST_F(gpu_culling_test, the_scene_has_polygons_at_the_same_depth) {
  scene::world_geometry world = rooms().world();
  const auto plain = source(world, bake::culling::none, 128);
  const std::uint32_t twins = rooms::side * rooms::side * 30;
  bake::hemicube_image image;
  std::size_t pixels = 0;
  for (const bake::pose& from : rooms::walk(24)) {
    plain->render_image(from, image);
    for (const std::uint32_t id : image.ids)
      pixels += id != scene::no_index && id + twins >= world.kinds.size() ? 1u : 0u;
  }
  EXPECT_GT(pixels, 1000u);
}

// Thousands of sheets across each other in one plane, all at one depth to the last bit: the order of the draws decides.
TEST_F(gpu_culling_test, of_sheets_in_one_plane_the_last_drawn_is_kept) {
  sightcell::test::tiny_scene sheets;
  std::mt19937 engine(5);
  const auto number = [&] { return static_cast<float>(engine() >> 8) / 8388608.0f - 1.0f; };
  for (int i = 0; i < 4000; ++i) {
    const float y = 3 * number(), z = 3 * number(), half = 0.3f + 0.2f * number();
    sheets.quad({2, y - half, z + half}, {2, y - half, z - half}, {2, y + half, z - half}, {2, y + half, z + half},
                {scene::alpha_mode::opaque, i % 5 == 0});
  }
  const scene::world_geometry world = scene::flatten(sheets.finished());
  const bake::pose along_x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  const bake::pose near_by{{0.5f, 0.25f, 0.5f}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  const auto plain = source(world, bake::culling::none, 64);
  bake::hemicube_image expected, image;
  for (const bake::culling how : {bake::culling::frustum, bake::culling::occlusion}) {
    const auto tested = source(world, how, 64);
    for (const bake::pose& from : {along_x, along_x, near_by, along_x}) {
      plain->render_image(from, expected);
      tested->render_image(from, image);
      expect_same_image(expected, image, how == bake::culling::frustum ? "frustum" : "occlusion");
    }
    EXPECT_GT(std::count(expected.inverse_depths.begin(), expected.inverse_depths.end(), 0.5f), 1000);
  }
}

// Heaps from a millimeter to a hundred meters wide, near and far, behind walls with slits, near the origin and far from
// it: whatever rounding does to boxes and depths, nothing that is seen may be culled.
TEST_F(gpu_culling_test, heaps_of_all_sizes_show_what_a_plain_draw_shows) {
  std::mt19937 engine(17);
  const auto number = [&] { return static_cast<float>(engine() >> 8) / 8388608.0f - 1.0f; };
  const auto vector = [&] { return glm::vec3(number(), number(), number()); };
  bake::hemicube_image expected, image;
  std::uint64_t in_frustum = 0, drawn = 0;
  for (int scene_number = 0; scene_number < 12; ++scene_number) {
    sightcell::test::tiny_scene heaps;
    const glm::vec3 middle = scene_number % 3 == 0 ? glm::vec3(0) : std::pow(10.0f, 2.0f + 1.5f * number()) * vector();
    for (int heap = 0; heap < 30; ++heap) {
      const float distance = std::pow(10.0f, 1.0f + 1.5f * number());
      const glm::vec3 center = middle + distance * glm::normalize(vector());
      const float width = distance * std::pow(10.0f, 2.0f * number() - 2.0f);
      for (int i = 0; i < 400; ++i) {
        const glm::vec3 a = center + width * vector();
        heaps.triangle(a, a + 0.3f * width * vector(), a + 0.3f * width * vector());
      }
    }
    for (int wall = 0; wall < 60; ++wall) {
      const glm::vec3 toward = glm::normalize(vector()), center = middle + std::pow(10.0f, number() + 0.5f) * toward;
      const float half = glm::length(center - middle);
      const glm::vec3 u = 0.6f * half * glm::normalize(glm::cross(toward, vector()));
      const glm::vec3 v = 0.6f * half * glm::normalize(glm::cross(toward, u));
      heaps.quad(center - u - v, center + u - v, center + u + v, center - u + v, {scene::alpha_mode::opaque, true});
    }
    const scene::world_geometry world = scene::flatten(heaps.finished());
    const auto plain = source(world, bake::culling::none, 64), frustum = source(world, bake::culling::frustum, 64);
    const auto tested = source(world, bake::culling::occlusion, 64);
    bake::pose from = rooms::walk(1)[0];
    for (int i = 0; i < 12; ++i) {
      from.eye = middle + std::pow(10.0f, static_cast<float>(i % 3) - 2.0f) * vector();
      if (i % 4 == 3) from = {from.eye, -from.right, from.forward, from.up};
      plain->render_image(from, expected);
      tested->render_image(from, image);
      expect_same_image(expected, image, "scene " + std::to_string(scene_number) + ", pose " + std::to_string(i));
      in_frustum += drawn_triangles(*frustum, from);
      drawn += drawn_triangles(*tested, from);
    }
  }
  EXPECT_LT(drawn, in_frustum * 9 / 10) << "something was hidden";
}

TEST_F(gpu_culling_test, what_is_hidden_is_not_drawn) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  const auto plain = source(world, bake::culling::none, 128), frustum = source(world, bake::culling::frustum, 128);
  const std::uint64_t everything = drawn_triangles(*plain, from), in_frustum = drawn_triangles(*frustum, from);
  EXPECT_EQ(everything, 5 * world.kinds.size());
  EXPECT_LT(in_frustum, everything);
  const auto occlusion = source(world, bake::culling::occlusion, 128);
  const std::uint64_t first = drawn_triangles(*occlusion, from);
  GLint steps = 0;  // coarse coordinates make more triangles uncertain; zink has the 4 bits that OpenGL guarantees
  glGetIntegerv(GL_SUBPIXEL_BITS, &steps);
  EXPECT_LT(first, in_frustum / (steps < 8 ? 2 : 3)) << "most face away or are between the centers of pixels";
  // Clusters are culled too: the first hemicube of a source knows nothing of what is hidden.
  EXPECT_LT(drawn_triangles(*occlusion, from), first / 2);
  EXPECT_LT(drawn_triangles(*occlusion, from), first / 2) << "and it does not forget";
  bake::pose back = from;
  back.forward = -from.forward;
  back.right = -from.right;
  drawn_triangles(*occlusion, back);
  EXPECT_LT(drawn_triangles(*occlusion, from), first / 2) << "while it looks the other way";
}

// Lists that have no room are drawn with all triangles of their clusters.
TEST_F(gpu_culling_test, without_room_for_triangles_the_image_is_the_same) {
  const scene::world_geometry world = rooms().world();
  const auto plain = source(world, bake::culling::none, 64);
  bake::hemicube_image expected, image;
  std::vector<std::uint64_t> drawn;
  // Without any room triangles are not even tested. One source after the other: with llvmpipe of Mesa 22.3.6 indirect
  // draws of one source have no triangles while another has indirect draws that read their number alone.
  for (const std::uint32_t most_triangles : {0u, 1u, 100u, 300u, 1'000'000u}) {
    const auto tested = source(world, bake::culling::occlusion, 64, most_triangles);
    drawn.push_back(0);
    for (const bake::pose& from : rooms::walk(6)) {
      plain->render_image(from, expected);
      tested->render_image(from, image);
      expect_same_image(expected, image, "room for " + std::to_string(most_triangles));
      bake::hemicube_view all, seen;
      plain->render(from, all);
      tested->render(from, seen);
      expect_same_view(all, seen, "room for " + std::to_string(most_triangles));
      drawn.back() += drawn_triangles(*tested, from);
    }
  }
  EXPECT_GT(drawn[0], drawn[1]);
  EXPECT_GT(drawn[1], drawn[2]);
  EXPECT_GT(drawn[2], drawn[3]);
  EXPECT_GT(drawn[3], drawn[4]);
  EXPECT_GT(drawn[4], 0u);
}

TEST_F(gpu_culling_test, a_scene_without_anything_that_hides) {
  sightcell::test::tiny_scene panes, empty;
  panes.wall_x(2, -1, 1, {scene::alpha_mode::blend, true});
  const bake::pose along_x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  bake::hemicube_view view;
  const scene::world_geometry two = scene::flatten(panes.finished()), nothing = scene::flatten(empty.finished());
  const auto with_panes = source(two, bake::culling::occlusion, 64);
  const auto with_nothing = source(nothing, bake::culling::occlusion, 64);
  for (int i = 0; i < 2; ++i) {
    with_panes->render(along_x, view);
    EXPECT_EQ(view.seen.size(), 2u);
    with_nothing->render(along_x, view);
    EXPECT_TRUE(view.seen.empty());
  }
}

}  // namespace
