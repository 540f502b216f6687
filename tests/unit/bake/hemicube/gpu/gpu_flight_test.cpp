// Several hemicubes on their way at once, and the counts that the device keeps between them.
#include <algorithm>

#include "cell_set/cell_set.h"
#include "hemicube/gpu/polygon_counts.h"
#include "unit/bake/hemicube/gpu/gpu_scene.h"
#include "unit/bake/sampler/sample_cell.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::expect_same_view;
using sightcell::test::rooms;
using sightcell::test::tiny_scene;

class gpu_flight_test : public sightcell::test::gpu_test {
 protected:
  static std::unique_ptr<bake::hemicube_source> source(const scene::world_geometry& world, bake::gather how,
                                                       std::uint32_t resolution = 64,
                                                       bake::culling hide = bake::culling::automatic) {
    return bake::make_gpu_source(*context_, world,
                                 {.resolution = resolution, .far_plane = 100.0f, .how = how, .hide = hide});
  }
};

TEST_F(gpu_flight_test, poses_of_one_call_are_answered_as_one_at_a_time) {
  const scene::world_geometry world = rooms().world();
  const std::vector<bake::pose> walk = rooms::walk(17);
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    for (const bake::culling hide : {bake::culling::frustum, bake::culling::occlusion}) {
      const auto alone = source(world, how, 64, hide), together = source(world, how, 64, hide);
      for (const std::size_t at_once : {0u, 1u, 2u, 3u, 4u, 17u}) {
        std::vector<bake::hemicube_view> views(at_once);
        together->render(std::span(walk).first(at_once), views);
        for (std::size_t i = 0; i < at_once; ++i) {
          bake::hemicube_view expected;
          alone->render(walk[i], expected);
          EXPECT_GT(expected.seen.size(), 10u);
          expect_same_view(expected, views[i], std::to_string(i) + " of " + std::to_string(at_once));
        }
      }
    }
  }
}

// The list of a hemicube grows beyond what is read at once, for one in the middle of others.
TEST_F(gpu_flight_test, a_hemicube_sees_many_times_what_the_last_one_saw) {
  tiny_scene specks;
  specks.wall_x(-3, 1, 2);
  for (int y = 0; y < 100; ++y)
    for (int z = 0; z < 100; ++z) {
      const glm::vec3 a(10, static_cast<float>(y) - 50, static_cast<float>(z) - 50);
      specks.triangle(a, a + glm::vec3(0, 0.7f, 0), a + glm::vec3(0, 0, 0.7f), {scene::alpha_mode::opaque, true});
    }
  const scene::world_geometry world = scene::flatten(specks.finished());
  const bake::pose along_x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  bake::pose back = along_x;
  back.forward.x = -1;
  back.right.z = -1;
  const std::vector<bake::pose> poses{back, along_x, back, along_x, along_x, back};
  std::vector<bake::hemicube_view> views(poses.size());
  source(world, bake::gather::compute, 512)->render(poses, views);
  const auto read_back = source(world, bake::gather::read_back, 512);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    bake::hemicube_view expected;
    read_back->render(poses[i], expected);
    EXPECT_GT(expected.seen.size(), poses[i].forward.x > 0 ? 5000u : 1u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(views[i].importance[k], expected.importance[k], 1e-4 * expected.importance[k]);
      expected.importance[k] = views[i].importance[k];
    }
    expect_same_view(expected, views[i], std::to_string(i));
  }
}

TEST_F(gpu_flight_test, an_image_between_two_hemicubes_changes_nothing) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    const auto tested = source(world, how);
    bake::hemicube_view before, after;
    bake::hemicube_image image;
    tested->render(from, before);
    EXPECT_TRUE(std::any_of(before.seen.begin(), before.seen.end(),
                            [&](const bake::seen_polygon& p) { return !world.kinds[p.id].occludes(); }));
    tested->render_image(from, image);
    tested->render(from, after);
    expect_same_view(before, after, "after an image");
  }
}

// The sampler's loop over a source that does all it can on the device, and over one that does nothing there.
TEST_F(gpu_flight_test, a_cell_has_the_same_set_by_either_way) {
  const scene::world_geometry world = rooms().world();
  const bake::box cell{{9, 1, 9}, {13, 2, 14}};
  const std::vector<glm::vec3> interior{{10, 1.5f, 10}, {12, 1.2f, 13}};
  const auto is_valid = [](const glm::vec3& place) { return place.x < 12.7f || place.z > 10; };
  const bake::sampling_plan plan{.sampler = "halton", .samples = 30, .geometry_inside = true};
  std::vector<std::vector<std::uint32_t>> sets;
  for (const auto& [how, hide] : {std::pair{bake::gather::read_back, bake::culling::none},
                                  std::pair{bake::gather::compute, bake::culling::occlusion}}) {
    bake::cell_set set(static_cast<std::uint32_t>(world.kinds.size()));
    const auto tested = source(world, how, 64, hide);
    EXPECT_GT(bake::sample_cell(plan, cell, interior, is_valid, *tested, set), 20u);
    sets.push_back(set.sorted());
  }
  EXPECT_GT(sets[0].size(), 100u);
  EXPECT_EQ(sets[0], sets[1]);
}

TEST_F(gpu_flight_test, the_parts_of_the_cost_are_told) {
  const scene::world_geometry world = rooms().world();
  const bake::pose from = rooms::walk(1)[0];
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    const auto tested = source(world, how);
    bake::hemicube_view view, split_view;
    tested->render(from, view);
    const auto split = tested->render_split(from, split_view);
    ASSERT_TRUE(split);
    EXPECT_GT(split->draw, 0.0);
    EXPECT_GT(split->gather, 0.0);
    expect_same_view(view, split_view, "split");
  }
}

}  // namespace
