#include "source/gpu_culling.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "gpu_scene.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::expect_same_view;
using sightcell::test::rooms;

class gpu_culling_test : public sightcell::test::gpu_test {
 protected:
  static std::unique_ptr<bake::hemicube_source> source(const scene::world_geometry& world, bake::culling how,
                                                       std::uint32_t resolution) {
    return bake::make_gpu_source(
        *context_, world, {.resolution = resolution, .far_plane = 100.0f, .how = bake::gather::read_back, .hide = how});
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

TEST_F(gpu_culling_test, what_is_hidden_is_not_drawn) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  const auto plain = source(world, bake::culling::none, 128), frustum = source(world, bake::culling::frustum, 128);
  const std::uint64_t everything = drawn_triangles(*plain, from), in_frustum = drawn_triangles(*frustum, from);
  EXPECT_EQ(everything, 5 * world.kinds.size());
  EXPECT_LT(in_frustum, everything);
  const auto occlusion = source(world, bake::culling::occlusion, 128);
  EXPECT_EQ(drawn_triangles(*occlusion, from), in_frustum) << "the first hemicube knows nothing yet";
  EXPECT_LT(drawn_triangles(*occlusion, from), in_frustum / 2);
  EXPECT_LT(drawn_triangles(*occlusion, from), in_frustum / 2) << "and it does not forget";
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
